//! What this image was built for; chosen by `build.rs`.

include!(concat!(env!("OUT_DIR"), "/image.rs"));
