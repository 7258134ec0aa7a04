//! The JSON files that are read back, `report.json` and `fixedmath/proof.json`: none makes the reader panic, and what is read is
//! written as it was read.
#![no_main]

use std::fmt::Debug;

use host::bench::operations::record::Record;
use host::render::report::Report;
use libfuzzer_sys::fuzz_target;
use serde::Serialize;
use serde::de::DeserializeOwned;

fn round_trip<T: Serialize + DeserializeOwned + Debug>(bytes: &[u8]) {
    let Ok(value) = serde_json::from_slice::<T>(bytes) else {
        return;
    };
    let text = serde_json::to_string(&value).expect("it is written");
    let again: T = serde_json::from_str(&text).expect("what was written is read");
    let second = serde_json::to_string(&again).expect("it is written");
    assert_eq!(second, text);
}

fuzz_target!(|bytes: &[u8]| {
    round_trip::<Report>(bytes);
    round_trip::<Record>(bytes);
});
