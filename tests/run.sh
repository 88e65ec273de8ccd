#!/usr/bin/env bash
# Sets up what the tests need and runs all of them: ./tests/run.sh
# One line a step; the end and the failures of a log are shown if its step fails. The last line has the totals.
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=web/tools.sh
source web/tools.sh

# One build of each program: what incremental builds keep takes gigabytes.
export CARGO_TERM_COLOR=never NO_COLOR=1 CARGO_INCREMENTAL=0
TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}"
LOGS="$TARGET_DIR/test-logs"
WASM=(--target wasm32-unknown-unknown)
FAILURE='^ *not ok | panicked at |^error'
# The number before a word of a line, and the sum at the end.
BEFORE='function before(word, i) { for (i = 2; i <= NF; i++) if ($i ~ "^" word) return $(i - 1) } END{print n + 0}'
passed=0
failed=0

# check NAME COMMAND…: a step that passes or fails as a whole.
check() {
  if run_step "$@"; then passed=$((passed + 1)); else failed=$((failed + 1)); fi
}

# suite NAME COMMAND…: a step whose tests are counted by what its runner printed.
suite() {
  local ended=0 ok bad
  run_step "$@" || ended=1
  # cargo test and wasm-bindgen: "test result: ok. 3 passed; 0 failed; …"; node: "# pass 3", "# fail 0"; pytest: "1 failed, 3 passed in …".
  ok=$(awk '/^test result: /{n += $4} /^# pass /{n += $3} /^[0-9]+ (failed|passed)/{n += before("passed")} '"$BEFORE" "$LOGS/$1.log")
  bad=$(awk '/^test result: /{n += $6} /^# fail /{n += $3} /^[0-9]+ (failed|passed)/{n += before("failed")} '"$BEFORE" "$LOGS/$1.log")
  # It did not build, it broke off, or it found no test: that is a failure too.
  if [ "$bad" -eq 0 ] && { [ "$ended" -ne 0 ] || [ "$ok" -eq 0 ]; }; then
    [ "$ended" -ne 0 ] || echo "  $1: no test ran"
    bad=1
  fi
  printf '  %d passed, %d failed in %s\n' "$ok" "$bad" "$1"
  passed=$((passed + ok))
  failed=$((failed + bad))
}

# run NAME COMMAND…: runs a step; its log, and a file with its seconds and its exit code.
run() {
  local name="$1" start=$SECONDS ended=0
  shift
  "$@" >"$LOGS/$name.log" 2>&1 </dev/null || ended=$?
  echo "$((SECONDS - start)) $ended $*" >"$LOGS/$name.part"
  mv "$LOGS/$name.part" "$LOGS/$name.end"
}

# run_step NAME [COMMAND…]: runs a step, or waits for one that runs beside the others, and prints its line.
run_step() {
  local name="$1" seconds ended command
  if [ $# -gt 1 ]; then
    run "$@"
  else
    until [ -e "$LOGS/$name.end" ]; do
      kill -0 "$BESIDE" 2>/dev/null || [ -e "$LOGS/$name.end" ] || return 1
      sleep 0.2
    done
  fi
  read -r seconds ended command <"$LOGS/$name.end"
  if [ "$ended" -eq 0 ]; then
    printf '✓ %-14s %4d s\n' "$name" "$seconds"
  else
    printf '✗ %-14s %4d s: %s (exit code %d)\n' "$name" "$seconds" "$command" "$ended"
    # The end of the log, then the first failures: "not ok 3 - …" of node, "panicked at" and "error" of Rust.
    { tail -n 60 "$LOGS/$name.log"; echo "failures:"; grep -m 60 -A 24 -E "$FAILURE" "$LOGS/$name.log" || :; } |
      head -n 400 | sed 's/^/    /'
  fi
  return "$ended"
}

# Beside the native steps these keep the second core busy; the last two need the native program.
run_beside() {
  run page build_page
  # The runner gives up after 20 s unless told otherwise; random scenes take longer on a slow machine.
  # In a folder of its own: builds in one folder wait for each other.
  run wasm env WASM_BINDGEN_TEST_TIMEOUT=600 CHROMEDRIVER="$(command -v chromedriver)" CARGO_TARGET_DIR="$TARGET_DIR/wasm" \
    cargo test --locked "${WASM[@]}" --no-default-features --features js-api --test wasm
  run python test_python
  until [ -e "$LOGS/programs.end" ]; do sleep 1; done
  run js test_js
  run browser node --test --test-reporter=tap --test-concurrency=2 tests/browser/*.test.mjs
}

need_test_tools
mkdir -p "$LOGS"
rm -f "$LOGS"/*.end

# Quick ones first.
check format cargo fmt --all -- --check
check format-python cargo fmt --manifest-path python/Cargo.toml -- --check
check scripts bash -n js/build.sh web/tools.sh web/serve.sh web/name_module.sh tests/run.sh .ci/run
rm -rf dist # so that no older page is tested
set -m # a process group of its own, to be ended as a whole
run_beside &
BESIDE=$!
set +m
trap 'kill -- "-$BESIDE" 2>/dev/null || :' EXIT
check lint cargo clippy --locked --workspace --all-targets -- -D warnings
check lint-core cargo clippy --locked --workspace --lib --no-default-features -- -D warnings
check lint-wasm cargo clippy --locked "${WASM[@]}" --lib --bins --test wasm -- -D warnings
check lint-core-wasm cargo clippy --locked "${WASM[@]}" --workspace --lib --no-default-features -- -D warnings
check lint-python cargo clippy --manifest-path python/Cargo.toml --locked -- -D warnings
check docs env RUSTDOCFLAGS=-Dwarnings cargo doc --locked --workspace --no-deps --lib
check programs cargo test --locked --workspace --no-run
suite native cargo test --locked --workspace --no-fail-fast
for example in simulate sweep; do
  check "example-$example" cargo run --locked --quiet --example "$example"
done
check page
suite wasm
suite python
suite js
suite browser

printf 'in %d min %d s\n' $((SECONDS / 60)) $((SECONDS % 60))
printf '%d passed, %d failed\n' "$passed" "$failed"
[ "$failed" -eq 0 ]
