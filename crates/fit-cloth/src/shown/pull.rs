//! The pull of a test among the forces on its clips.

use cloth_fit::stage::report::ForceRow;

/// The rows of the force component that is largest: the pull, on the clip where it was measured. Its direction may turn
/// with the clip; its place among the clip's components stays.
pub(crate) fn pulled_rows(rows: &[ForceRow]) -> Vec<&ForceRow> {
    let place = |index: usize| {
        let own = |row: &&ForceRow| row.frame == rows[index].frame && row.clip == rows[index].clip;
        (rows[index].clip, rows[..index].iter().filter(own).count())
    };
    let size = |index: &usize| rows[*index].measured.abs();
    let largest = (0..rows.len()).max_by(|a, b| size(a).total_cmp(&size(b))).map(place);
    (0..rows.len()).filter(|&index| Some(place(index)) == largest).map(|index| &rows[index]).collect()
}
