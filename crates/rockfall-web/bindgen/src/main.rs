//! Generates JavaScript and TypeScript declarations for a WebAssembly file: `rockfall-web-bindgen FILE.wasm FOLDER`.

use std::process::ExitCode;

use wasm_bindgen_cli_support::Bindgen;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [input, folder] = arguments.as_slice() else {
        eprintln!("usage: rockfall-web-bindgen FILE.wasm FOLDER");
        return ExitCode::from(2);
    };
    let generate = || {
        let mut bindgen = Bindgen::new();
        bindgen.input_path(input).out_name("rockfall").typescript(true).web(true)?;
        // The module loads the file beside it, unless the caller gives another one.
        bindgen.omit_default_module_path(false).remove_name_section(true).generate(folder)
    };
    match generate() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
