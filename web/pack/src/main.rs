//! Pack: turns the page's WebAssembly into files for a browser, beside the page's own.
//!
//! `forerun-web-pack FROM.wasm STATIC DIST`

use std::error::Error;
use std::path::Path;

use wasm_bindgen_cli_support::Bindgen;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [wasm, page, dist] = arguments.as_slice() else {
        return Err("usage: forerun-web-pack FROM.wasm STATIC DIST".into());
    };
    let dist = Path::new(dist);
    if dist.is_dir() {
        std::fs::remove_dir_all(dist)?;
    }
    std::fs::create_dir_all(dist)?;
    // Names of functions are for debuggers only.
    Bindgen::new()
        .input_path(wasm)
        .web(true)?
        .typescript(false)
        .remove_name_section(true)
        .remove_producers_section(true)
        .generate(dist)?;
    for entry in std::fs::read_dir(page)? {
        let entry = entry?;
        std::fs::copy(entry.path(), dist.join(entry.file_name()))?;
    }
    Ok(())
}
