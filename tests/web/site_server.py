"""Static server on loopback for tests of streamed pages: counts what it sends; hooks delay, drop, cut and change answers.

Needs nothing but Python. SiteServer(folder) serves a folder within a `with` block.
"""
import http.server
import mimetypes
import pathlib
import re
import threading
import time
import urllib.parse

DROP = "drop"  # in place of an answer: the connection ends without one


class SiteServer:
    """
    origin   that may read: Access-Control-Allow-Origin
    ranges   whether single ranges are answered by 206
    answers  {end of a path: DROP, a status or bytes in place of the file}; a callable gets the file's bytes and returns one
             of these, or the bytes to send
    head     fields of every answer
    part     a callable that gets the beginning of a range, its bytes, and the fields of the answer, which it may change, and
             returns one of the above
    """

    def __init__(self, folder, origin=None, ranges=False):
        self.folder, self.origin, self.ranges = pathlib.Path(folder).resolve(), origin, ranges
        self.reset()
        server = self

        class Handler(http.server.BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"
            timeout = 60

            def do_GET(self):
                server.answer(self)

            def do_HEAD(self):
                server.send(self, 200, "application/octet-stream", b"", {})

            def log_message(self, *_):
                pass

        class Threads(http.server.ThreadingHTTPServer):
            daemon_threads = True

            def handle_error(self, *_):  # a browser that leaves
                pass

        self.server = Threads(("127.0.0.1", 0), Handler)
        self.url = f"http://127.0.0.1:{self.server.server_address[1]}/"

    def reset(self):
        self.answers, self.part, self.head = {}, None, {}
        self.tag = None           # ETag of all files
        self.asked = []           # ranges, in order: (first, last)
        self.delay_s = 0          # before each answer
        self.bytes_per_s = None   # of each connection
        self.paths = []           # requests, in order
        self.sent = 0             # bytes of bodies
        self.cut_off = 0          # answers that the browser did not wait for

    def __enter__(self):
        # Looks for the end a hundred times a second, not twice: every test waits for that.
        self.thread = threading.Thread(target=self.server.serve_forever, args=(0.01,), daemon=True)
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.server.shutdown()
        self.server.server_close()

    def chunks(self, ending=".vogz"):
        """Requests of chunks, in order."""
        return [path for path in self.paths if path.startswith("/chunks/") and path.endswith(ending)]

    def answer(self, request):
        path = urllib.parse.urlsplit(request.path).path
        self.paths.append(path)
        file = (self.folder / path.lstrip("/")).resolve()
        if path.endswith("/"):
            file /= "index.html"
        there = file.is_file() and self.folder in file.parents
        body = file.read_bytes() if there else 404
        for ending, answer in list(self.answers.items()):
            if path.endswith(ending):
                body = answer(body) if callable(answer) else answer
        time.sleep(self.delay_s)
        if body == DROP:
            request.close_connection = True
            return
        status, body = (body, b"") if isinstance(body, int) else (200, body)
        fields = {"ETag": self.tag} if self.tag else {}
        if status == 200 and self.ranges and (asked := re.fullmatch(r"bytes=(\d+)-(\d+)", request.headers.get("Range", ""))):
            first, last = int(asked[1]), min(int(asked[2]), len(body) - 1)
            self.asked.append((first, int(asked[2])))
            fields["Content-Range"] = f"bytes {first}-{last}/{len(body)}"
            status, body = (206, body[first:last + 1]) if first <= last else (416, b"")
            if self.part:
                answer = self.part(first, body, fields)
                if answer == DROP:
                    request.close_connection = True
                    return
                status, body = (answer, b"") if isinstance(answer, int) else (206, answer)
        try:
            self.send(request, status, mimetypes.guess_type(file.name)[0] or "application/octet-stream", body, fields)
        except OSError:
            self.cut_off += 1
            request.close_connection = True

    def send(self, request, status, kind, body, fields):
        request.send_response(status)
        request.send_header("Content-Type", kind)
        request.send_header("Content-Length", str(len(body)))
        request.send_header("Cache-Control", "no-store")  # so that every request is counted
        for name, value in (self.head | fields).items():
            request.send_header(name, value)
        if self.origin:
            request.send_header("Access-Control-Allow-Origin", self.origin)
        request.end_headers()
        step = len(body) or 1
        if self.bytes_per_s:
            step = max(1, self.bytes_per_s // 20)
        for at in range(0, len(body), step):
            request.wfile.write(body[at:at + step])
            self.sent += len(body[at:at + step])
            if rate := self.bytes_per_s:
                time.sleep(step / rate)
