//! `report.json`, from which a page is rebuilt.

#![no_main]

use fit_cloth::page::Page;
use fit_cloth_fuzz::{Sample, answer};
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static SAMPLE: LazyLock<Sample> = LazyLock::new(Sample::default);

fuzz_target!(|bytes: &[u8]| {
    SAMPLE.put("back/report.json", bytes);
    let folder = SAMPLE.path("back");
    let Some(page) = answer(Page::read(&folder), bytes) else { return };
    page.write(&folder).expect("what was read can be written");
    assert_eq!(Page::read(&folder).expect("what was written can be read"), page);
});
