#!/usr/bin/env bash
# Builds the JavaScript package into js/dist: ./js/build.sh [PROGRAM]
# Its WebAssembly is that of the page without the window, the benchmark and the schemas. PROGRAM is the native program, which writes the
# schemas; it is built if it is not given.
set -euo pipefail
program="${1:+$(realpath "$1")}"
cd "$(dirname "$0")/.."
# shellcheck source=web/tools.sh
source web/tools.sh
need_package_tools

rm -rf js/dist
# Bodies for size here, for speed in the page: a fit of 50 000 triangles takes 0.2 s here and 0.1 s there.
wasm-pack --quiet build --mode no-install --no-pack --no-opt --target web --profile web --out-dir js/dist/wasm . \
  --locked --no-default-features --features js-package --config 'profile.web.package.implant-preview-body.opt-level="z"'
# More passes make the file shorter and its compressed copy longer.
wasm=js/dist/wasm/implant_preview_bg.wasm
wasm-opt "$wasm" --output "$wasm" -O1 --strip-debug --strip-producers --enable-bulk-memory --enable-bulk-memory-opt \
  --enable-multivalue --enable-mutable-globals --enable-nontrapping-float-to-int --enable-reference-types --enable-sign-ext \
  --enable-simd
rm js/dist/wasm/.gitignore # npm would leave the folder out

# Types of the formats, then the typed functions.
if [ -z "$program" ]; then
  cargo build --quiet --locked
  program="${CARGO_TARGET_DIR:-target}/debug/implant-preview"
fi
node js/types.mjs js/dist/types "$program"
js/node_modules/.bin/tsc --project js
cp LICENSE-APACHE LICENSE-MIT js
