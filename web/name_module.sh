#!/usr/bin/env bash
# Run by trunk after a build. The program's files have a hash in their names; this writes a module of
# a fixed name that passes on what they export, for scripts that index.html does not load.
set -euo pipefail
cd "$TRUNK_STAGING_DIR"
scripts=(implant-preview-*.js)
if [ ${#scripts[@]} -ne 1 ] || [ ! -e "${scripts[0]%.js}_bg.wasm" ]; then
  echo "name_module.sh: one implant-preview-….js and its wasm file were expected, not: ${scripts[*]}" >&2
  exit 1
fi
name="${scripts[0]%.js}"
cat >implant-preview.mjs <<END
export * from "./$name.js";
export { default } from "./$name.js";
export const wasm = new URL("./${name}_bg.wasm", import.meta.url);
END
