//! The smallest possible study: its tables are consistent on any machine.

#![allow(clippy::unwrap_used)]

use cloth_sim::material::Model;
use cloth_study::extent::{Extent, Topic};
use cloth_study::level::levels;
use cloth_study::pareto::front;
use cloth_study::run::{Ending, Part};
use cloth_study::solver::Solver;
use cloth_study::study::{Study, run};
use cloth_study::subject::Subject;
use cloth_study::table::{ablation_csv, study_csv, study_json};
use fit_cloth::progress::Progress;
use fit_cloth::text;

fn smallest() -> Extent {
    Extent {
        topics: Topic::ALL.to_vec(),
        models: vec![Model::STVK],
        meshes: vec![13, 25],
        finest: 49,
        tolerances_on: 13,
        fit_nodes: vec![7],
        published_nodes: vec![7],
        usual_nodes: 7,
        points: vec![1],
        every_frames: vec![2],
        noises: vec![1.0],
        seeds: 12,
        noise_nodes: 13,
        rig_nodes: 25,
    }
}

/// A study of a set without bending tests.
fn study() -> Study {
    let extent = smallest();
    let mut subject = Subject::built_in(&extent).unwrap();
    subject.set.sequences.retain(|sequence| sequence.table.is_none());
    run(&subject, &extent, &Progress::new("study", false)).unwrap()
}

#[test]
fn a_study_holds_together() {
    let study = study();
    // Orders of convergence from three meshes, for smooth scenes. The strip bends most near its bars, within two cells
    // of the coarsest mesh: from 25 nodes on its order is 2.1.
    for (scene, near_two) in [("sagging strip", 1.8..3.0), ("picture frame", 1.7..2.6)] {
        let order = study.part(Part::Equilibrium).filter(|run| run.test == scene).find_map(|run| run.order);
        println!("{scene}: order {order:?}");
        assert!(near_two.contains(&order.unwrap()), "{scene}: {order:?}");
    }
    for run in study.part(Part::Equilibrium).filter(|run| run.nodes < 49) {
        assert!(run.failed() || run.error_position_mm.is_some(), "{run:?}");
    }
    // Both solvers find the same equilibria.
    let error = |solver| {
        let mut runs = study.part(Part::Equilibrium).filter(|r| r.test == "bars in shear" && r.nodes == 25);
        runs.find(|run| run.solver == solver).unwrap().error_position_mm.unwrap()
    };
    assert!((error(Solver::Default) / error(Solver::AsPublished) - 1.0).abs() < 0.01);

    // Without bending tests there are no bending curves, and every fit reports it.
    let fits: Vec<_> = study.part(Part::Fit).collect();
    assert_eq!(fits.len(), 4);
    for run in &fits {
        assert!(matches!(&run.ending, Ending::Failed(why) if why.contains("bend-weft")), "{run:?}");
        assert!(run.error_curve.unwrap() < 0.3);
    }
    let stages = study.part(Part::Stage).filter(|run| run.test.starts_with("stretch"));
    assert!(stages.filter(|run| run.points == Some(5)).all(|run| run.error_curve.unwrap() < 0.01));

    // Near the Cramér–Rao bound, where noise is the only error.
    for level in levels(&study).iter().filter(|level| level.test.ends_with("own mesh")) {
        let ratio = level.error / level.floor.unwrap();
        println!("{}: {ratio:.2} times the floor", level.test);
        assert!((0.4..1.7).contains(&ratio), "{level:?}");
    }
    let part = |name: &str| study.ablation.iter().find(|row| row.part == name).unwrap();
    assert!(part("weight, and what it needs").error_force.unwrap() > 1e-4);
    assert!(part("out-of-plane unknowns").error_force.unwrap() < 1e-6);
    tables_hold_together(&study);
}

fn tables_hold_together(study: &Study) {
    let csv = study_csv(study);
    let mut lines = csv.lines();
    assert!(
        lines.next().unwrap().starts_with("part,test,model,solver,nodes,points,frames,noise,tolerance,seed,")
    );
    assert_eq!(lines.count(), study.runs.len());
    for text in [&csv, &ablation_csv(study), &study_json(study).to_string(), &text::study_page(study)] {
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }
    assert_eq!(csv.matches(",true,").count(), study.runs.iter().filter(|run| run.failed()).count());
    for section in text::sections(study) {
        assert!(section.rows.iter().all(|row| row.len() == section.header.len()), "{}", section.title);
    }
    let points: Vec<[f64; 2]> =
        study.part(Part::Fit).filter_map(|run| Some([run.spent.seconds, run.error_curve?])).collect();
    let best = front(&points);
    assert!(
        !best.is_empty() && best.windows(2).all(|pair| pair[0][0] < pair[1][0] && pair[0][1] > pair[1][1])
    );
    for point in &points {
        // No run is both faster and clearly better than the whole front.
        assert!(best.iter().any(|on| on[0] <= point[0] && on[1] <= point[1] / 0.99), "{point:?} {best:?}");
    }
}

#[test]
fn the_truth_behind_a_set_is_known_by_its_name() {
    let extent = smallest();
    let mut set = Subject::built_in(&Extent { rig_nodes: 13, ..extent }).unwrap().set;
    let named = |name: &str, set: &mut cloth_data::frame::MeasurementSet| {
        set.fabric.name = name.into();
        let subject = Subject::of_set(set.clone()).unwrap();
        (subject.is_known, subject.fabric.name)
    };
    assert_eq!(named("wool-cotton", &mut set), (true, "wool-cotton".into()));
    assert_eq!(named("wool-cotton.2", &mut set), (true, "wool-cotton.2".into()));
    assert_eq!(named("my wool", &mut set), (false, "cotton-denim".into()));
}

#[test]
fn an_output_folder_that_is_no_study_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("notes.txt"), "mine").unwrap();
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_fit-cloth"))
        .args(["study", "--quick", "--out"])
        .arg(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stderr).contains("other things"));
    assert!(folder.path().join("notes.txt").is_file());
}
