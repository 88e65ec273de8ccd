#!/usr/bin/env bash
# Builds the page and serves it on this machine: ./web/serve.sh [port]
set -euo pipefail
cd "$(dirname "$0")/.."
source web/tools.sh

port="${1:-8080}"
case "$port" in
  '' | *[!0-9]*) echo "usage: $0 [port]; the port is a number from 1 to 65535, not '$port'" >&2; exit 2 ;;
esac
need_page_tools
need_packages python3=python3
build_page
exec python3 web/serve.py dist "$port"
