# Sets up what building and testing the page needs; sourced by web/serve.sh, js/build.sh and tests/run.sh.
# Everything that is already there is left alone, and then no network is used.
# shellcheck shell=bash

# Where downloaded tools go; the target folder is not part of the repository.
TOOLS_DIR="${CARGO_TARGET_DIR:-$PWD/target}/tools"
TRUNK_VERSION=0.21.14
WASM_PACK_VERSION=0.15.1
BINARYEN_VERSION=132.0.0

say() { printf '· %s\n' "$*"; }

# The version of a crate in Cargo.lock.
locked_version() {
  awk -v name="$1" '$1 == "name" && $3 == "\"" name "\"" { getline; gsub(/"/, "", $3); print $3; exit }' Cargo.lock
}

# Is a command there, and does it print this version?
has_version() {
  command -v "$1" >/dev/null && "$1" --version 2>/dev/null | grep -qwF "$2"
}

# Debian packages that are missing are installed; the arguments are "file-or-command=package".
need_packages() {
  local missing=() pair probe
  for pair in "$@"; do
    probe="${pair%%=*}"
    command -v "$probe" >/dev/null || [ -e "$probe" ] || missing+=("${pair##*=}")
  done
  [ ${#missing[@]} -eq 0 ] && return
  local root=()
  [ "$(id -u)" -eq 0 ] || root=(sudo)
  if ! command -v apt-get >/dev/null; then
    echo "missing: ${missing[*]}. Install them with your package manager and run this again." >&2
    exit 1
  fi
  say "installing ${missing[*]}"
  "${root[@]}" apt-get update -qq
  DEBIAN_FRONTEND=noninteractive "${root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

# Builds a tool of crates.io: build_tool WORDS OPT-LEVEL ARGUMENTS-OF-CARGO-INSTALL. Tools run for seconds: compiling
# quickly saves more than it costs. The words say how long it takes on two idle cores; a line every 15 s shows progress.
build_tool() {
  local words="$1" level="$2" log="$TOOLS_DIR/build.log" start=$SECONDS
  shift 2
  mkdir -p "$TOOLS_DIR"
  say "$words, once"
  CARGO_PROFILE_RELEASE_OPT_LEVEL=$level CARGO_PROFILE_RELEASE_CODEGEN_UNITS=256 CARGO_PROFILE_RELEASE_LTO=off \
    CARGO_PROFILE_RELEASE_DEBUG=0 CARGO_TERM_COLOR=never cargo install "$@" >"$log" 2>&1 &
  local job=$!
  while kill -0 "$job" 2>/dev/null; do
    sleep 1
    # One line every 15 s: how many crates are compiled.
    [ $(((SECONDS - start) % 15)) -ne 0 ] || printf '  %3d s, %d crates compiled\n' \
      $((SECONDS - start)) "$(grep -c '^ *Compiling' "$log" || true)"
  done
  wait "$job" || { tail -n 30 "$log" >&2; return 1; }
}

need_rust() {
  export PATH="$HOME/.cargo/bin:$PATH"
  if ! command -v cargo >/dev/null; then
    echo "Rust is missing. Install it from https://rustup.rs and run this again." >&2
    exit 1
  fi
  if [ ! -d "$(rustc --print sysroot)/lib/rustlib/wasm32-unknown-unknown" ]; then
    say "adding the wasm32 target"
    rustup target add wasm32-unknown-unknown
  fi
}

# What the page is built with: trunk, wasm-bindgen of the locked version, wasm-opt.
need_page_tools() {
  need_rust
  need_packages cc=build-essential npm=npm
  if ! has_version trunk "$TRUNK_VERSION"; then
    # Without TLS: trunk finds its own tools on the PATH and downloads none.
    build_tool "building trunk $TRUNK_VERSION (about 2 minutes)" 0 \
      --locked --no-default-features "trunk@$TRUNK_VERSION"
  fi
  local bindgen
  bindgen="$(locked_version wasm-bindgen)"
  if ! has_version wasm-bindgen "$bindgen"; then
    build_tool "building wasm-bindgen $bindgen (about 1.5 minutes)" 1 "wasm-bindgen-cli@$bindgen"
  fi
  # wasm-opt of older Binaryen breaks what wasm-bindgen makes today: only this version is used.
  if ! has_version "$TOOLS_DIR/node_modules/.bin/wasm-opt" "version_${BINARYEN_VERSION%%.*}"; then
    say "fetching wasm-opt (binaryen $BINARYEN_VERSION)"
    npm install --loglevel=error --no-audit --no-fund --prefix "$TOOLS_DIR" "binaryen@$BINARYEN_VERSION" >/dev/null
  fi
  export PATH="$TOOLS_DIR/node_modules/.bin:$PATH"
}

# need_modules FOLDER WORDS: the npm packages of a folder.
need_modules() {
  # npm writes its own list of what it has installed.
  if [ ! "$1/node_modules/.package-lock.json" -nt "$1/package-lock.json" ]; then
    say "fetching $2"
    (cd "$1" && npm ci --loglevel=error --no-audit --no-fund >/dev/null)
  fi
}

# What the JavaScript package is built with: wasm-pack, TypeScript.
need_package_tools() {
  need_page_tools
  if ! has_version wasm-pack "$WASM_PACK_VERSION"; then
    build_tool "building wasm-pack $WASM_PACK_VERSION (about 2 minutes)" 1 --locked "wasm-pack@$WASM_PACK_VERSION"
  fi
  need_modules js "what makes types from schemas"
}

# What the tests need besides: a browser, its driver, GNU parallel, what drives the page.
need_test_tools() {
  need_package_tools
  need_packages chromium=chromium chromedriver=chromium-driver parallel=parallel
  need_modules tests/browser "what drives the page and reads its files"
}

# Builds the Python module's wheel, installs it in a fresh environment and tests it there.
test_python() {
  need_packages python3=python3
  python3 -c 'import ensurepip' 2>/dev/null || need_packages no-ensurepip=python3-venv
  python3 -m venv --clear "$TOOLS_DIR/python"
  local python="$TOOLS_DIR/python/bin/python"
  # From the folder of the tests: the installed module is tested, not the one of the checkout. Joined: a step is no place for `set -e`.
  CARGO_TARGET_DIR="$TOOLS_DIR/python-target" "$python" -m pip install --quiet --disable-pip-version-check "./python[test]" &&
    "$python" -m mypy --strict python/implant_preview &&
    (cd python/tests && "$python" -m pytest -q)
}

# Builds the JavaScript package and tests its tarball. The native program writes the schemas and is compared with.
test_js() {
  js/build.sh "${CARGO_TARGET_DIR:-target}/debug/implant-preview" &&
    node --test --test-reporter=tap tests/js/*.test.mjs
}

# Builds dist/, unless it is newer than everything it is made of.
build_page() {
  local built="$TOOLS_DIR/page-built" newer=none
  if [ -e dist/index.html ] && [ -e "$built" ]; then
    newer=$(find .cargo assets body charts core lab solver src view web index.html Cargo.lock Cargo.toml Trunk.toml -newer "$built" -print -quit)
  fi
  [ -n "$newer" ] || return 0
  say "building the page (a few minutes the first time)"
  # trunk takes NO_COLOR for an option of its own and refuses the usual values.
  touch "$built.begun"
  env -u NO_COLOR trunk build --quiet || return
  mv "$built.begun" "$built"
}
