"""Serves a folder on 127.0.0.1: python3 serve.py FOLDER PORT (the next free port if it is taken).

A file goes out compressed if its compressed copy (.br, .gz) stands beside it and the browser accepts the encoding.
"""

import functools
import http.server
import os
import sys
import urllib.parse

# In order of preference, the smallest first.
ENCODINGS = {"br": ".br", "gzip": ".gz"}


def accepted(header):
    """The encodings that an Accept-Encoding header allows."""
    names = set()
    for part in header.lower().split(","):
        name, *parameters = (word.strip() for word in part.split(";"))
        if not any(word.replace(" ", "") in ("q=0", "q=0.0", "q=0.00", "q=0.000") for word in parameters):
            names.add(name)
    return names


class Handler(http.server.SimpleHTTPRequestHandler):
    extensions_map = {
        **http.server.SimpleHTTPRequestHandler.extensions_map,
        ".wasm": "application/wasm",
        ".js": "text/javascript",
        ".mjs": "text/javascript",
        ".svg": "image/svg+xml",
        ".webmanifest": "application/manifest+json",
    }
    encoding = None

    def translate_path(self, path):
        """The file of an address, or its compressed copy."""
        self.encoding = None
        file = super().translate_path(path)
        # The address of a folder without the slash is redirected by the base class.
        if os.path.isdir(file) and urllib.parse.urlsplit(path).path.endswith("/"):
            index = os.path.join(file, "index.html")
            file = index if os.path.exists(index) else file
        names = accepted(self.headers.get("Accept-Encoding", ""))
        for encoding, suffix in ENCODINGS.items():
            if encoding in names and os.path.isfile(file + suffix):
                self.encoding = encoding
                return file + suffix
        return file

    def guess_type(self, path):
        return super().guess_type(path.removesuffix(ENCODINGS[self.encoding]) if self.encoding else path)

    def end_headers(self):
        if self.encoding:
            self.send_header("Content-Encoding", self.encoding)
        self.send_header("Vary", "Accept-Encoding")
        # A rebuilt page is shown at the next reload.
        self.send_header("Cache-Control", "no-cache")
        super().end_headers()

    def log_message(self, *_):
        pass


def main():
    folder, port = sys.argv[1], int(sys.argv[2])
    handler = functools.partial(Handler, directory=folder)
    for candidate in range(port, min(port + 20, 65536)):
        try:
            server = http.server.ThreadingHTTPServer(("127.0.0.1", candidate), handler)
        except OSError:
            continue
        print(f"implant-preview: http://127.0.0.1:{candidate}/  (Ctrl+C ends it)", flush=True)
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            print()
        return
    sys.exit(f"no free port from {port} to {port + 19}; name another: ./web/serve.sh PORT")


main()
