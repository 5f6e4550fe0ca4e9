//! Selection of the pulling force of a test.

use cloth_fit::stage::report::ForceRow;

/// The rows of the largest measured force component: the pull. Its direction may turn with the clip, but its index
/// among the clip's components is the same in every frame.
pub(crate) fn pulled_rows(rows: &[ForceRow]) -> Vec<&ForceRow> {
    let place = |index: usize| {
        let own = |row: &&ForceRow| row.frame == rows[index].frame && row.clip == rows[index].clip;
        (rows[index].clip, rows[..index].iter().filter(own).count())
    };
    let size = |index: &usize| rows[*index].measured.abs();
    let largest = (0..rows.len()).max_by(|a, b| size(a).total_cmp(&size(b))).map(place);
    (0..rows.len()).filter(|&index| Some(place(index)) == largest).map(|index| &rows[index]).collect()
}
