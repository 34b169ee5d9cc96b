#!/usr/bin/env python3
"""vog serve against paths, links, heads and clients that are not a browser's. VOG_COMMAND names the command."""
import http.client
import os
import socket
import threading
import time

from serve_test_case import CHUNK, SECONDS, ServeTest, received, run


class Paths(ServeTest):
    def test_no_path_leaves_the_folder(self):
        for path in [
            "/../secret.txt", "/..", "/../", "/chunks/../../secret.txt", "/chunks/../index.html", "/./index.html", "/chunks/.",
            "/%2e%2e/secret.txt", "/%2E%2E/secret.txt", "/.%2e/secret.txt", "/%2e./secret.txt", "/..%2fsecret.txt", "/..%2Fsecret.txt",
            "/chunks%2f..%2f..%2fsecret.txt", "/%2e%2e%2fsecret.txt", "/%2fetc/passwd", "//etc/passwd", "/%2f%2fetc/passwd",
            "/..\\secret.txt", "/..%5csecret.txt", "/chunks\\other.vogz", "/%252e%252e/secret.txt", "/%252e%252e%252fsecret.txt",
            "/..%252fsecret.txt", "/%25252e%25252e/secret.txt", "/%c0%ae%c0%ae/secret.txt", "/%c0%af../secret.txt", "/%u002e%u002e/secret.txt",
            "/%uff0e%uff0e/secret.txt", "/..;/secret.txt", "/.../secret.txt", "/index.html%00", "/index.html%00.txt", "/%00", "/..%00/secret.txt",
            "/index.html%0a", "/%0d%0aX:%20y", "/index.html%7f", "/index.html/", "/index.html/..", "/index.html/../../secret.txt",
            "/../site-beside/x.txt", "/%", "/%2", "/%zz", "/%-1", "/index.html%2", "/" + "a" * 300, "/" + "a/" * 2000, "/" + "../" * 2000 + "etc/passwd",
            "/~root", "/proc/self/environ",
        ]:
            status, body = self.server.status(path)
            self.assertEqual((status, body), (404, b"no such file\n"), path[:60])

    def test_a_target_that_is_no_path_names_nothing(self):
        for path in [b"index.html", b"../secret.txt", b"http://localhost/index.html", b"*", b"/\xc3\xbc", b"/\x1b[2J", b"\\index.html", b"/index.html\tx"]:
            self.assertEqual(self.server.status(path)[0], 404, path)
        for path in [b"", b"/a b", b"/index.html\x00"]:
            self.assertEqual(self.server.status(path)[0], 400, path)

    def test_hidden_files_and_folders_are_not_served(self):
        for path in ["/.hidden", "/%2ehidden", "/.folder/x.txt", "/chunks", "/chunks/", "/.folder/"]:
            self.assertEqual(self.server.status(path)[0], 404, path)

    def test_links_within_the_folder_are_followed_and_others_are_not(self):
        links = {"in.html": "index.html", "chunks/up.html": "../index.html", "part": "chunks", "out.txt": "../secret.txt", "up": "..", "root": "/",
                 "absolute.txt": str(self.folder / "secret.txt"), "beside": "../site-beside", "hidden.txt": ".hidden", "folder": ".folder",
                 "loop": "loop", "nowhere": "absent.txt", "twice.txt": "out.txt", "shadow": "/etc/passwd"}
        for name, target in links.items():
            os.symlink(target, self.site / name)
            self.addCleanup(os.unlink, self.site / name)
        for path, file in [("/in.html", "index.html"), ("/chunks/up.html", "index.html"), ("/part/other.vogz", "chunks/other.vogz")]:
            self.assertEqual(self.server.status(path), (200, (self.site / file).read_bytes()), path)
        for path in ["/out.txt", "/up/secret.txt", "/up/site/index.html", "/root/etc/passwd", "/absolute.txt", "/beside/x.txt", "/hidden.txt",
                     "/folder/x.txt", "/loop", "/nowhere", "/twice.txt", "/shadow"]:
            expected = 200 if path == "/up/site/index.html" else 404  # which is within
            self.assertEqual(self.server.status(path)[0], expected, path)

    def test_what_is_no_regular_file_is_not_opened(self):
        os.mkfifo(self.site / "pipe.txt")
        self.addCleanup(os.unlink, self.site / "pipe.txt")
        with socket.socket(socket.AF_UNIX) as listener:
            listener.bind(str(self.site / "socket.txt"))
            self.addCleanup(os.unlink, self.site / "socket.txt")
            for path in ["/pipe.txt", "/socket.txt"]:
                self.assertEqual(self.server.status(path)[0], 404, path)

    def test_a_folder_that_becomes_a_link_shows_no_secret(self):
        """The name of a folder that is a link to the one above in between."""
        swapped, kept, ends = self.site / "swapped", self.site / "kept", threading.Event()
        swapped.mkdir()
        (swapped / "secret.txt").write_text("public")

        def swap():
            while not ends.is_set():
                swapped.rename(kept)
                os.symlink("..", swapped)
                swapped.unlink()
                kept.rename(swapped)

        thread = threading.Thread(target=swap)
        thread.start()
        client = http.client.HTTPConnection("127.0.0.1", self.server.port, timeout=SECONDS)
        bodies = set()
        try:
            for _ in range(900):  # of 1000 on one connection
                client.request("GET", "/swapped/secret.txt")
                bodies.add(client.getresponse().read())
        finally:
            ends.set()
            thread.join()
            client.close()
            (swapped / "secret.txt").unlink()
            swapped.rmdir()
        self.assertLessEqual(bodies, {b"no such file\n", b"public"})


class Heads(ServeTest):
    def test_other_methods_are_refused(self):
        for method in [b"POST", b"PUT", b"DELETE", b"PATCH", b"OPTIONS"]:
            answer = self.server.raw(method + b" / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 3\r\nConnection: close\r\n\r\nabc")
            self.assertTrue(answer.startswith(b"HTTP/1.1 405 "), answer[:40])
            self.assertIn(b"Allow: GET, HEAD\r\n", answer)
        for method in [b"TRACE", b"CONNECT", b"get", b"X"]:  # cpp-httplib's answer
            self.assertEqual(self.server.status("/", method=method)[0], 400, method)

    def test_bodies_are_never_taken_for_requests(self):
        hidden = b"GET /manifest.json HTTP/1.1\r\nHost: localhost\r\n\r\n"
        for status, body in [(405, hidden), (413, hidden * 300)]:
            head = b"POST / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nContent-Length: %d\r\n\r\n" % len(body)
            answer = self.server.raw(head + body)
            self.assertEqual((answer.count(b"HTTP/1.1 "), answer.split(b" ")[1]), (1, b"%d" % status))

    def test_a_long_line_is_refused(self):
        self.assertEqual(self.server.status("/" + "a" * 9000)[0], 414)

    def test_hosts_of_other_names_are_refused(self):
        """A page whose name server gives it this machine's address does not read the site."""
        for host in ["localhost", "LocalHost", "127.0.0.1", "[::1]", "localhost:1", "127.0.0.1:65535", "127.0.0.2", "[::1]:8080", f"localhost:{self.server.port}"]:
            self.assertEqual(self.server.get("/", Host=host)[0].status, 200, host)
        for host in ["evil.example", "evil.example:8080", "localhost.evil.example", "127.0.0.1.evil.example", "localhost:80:80", "localhost:x", "", ":80", "[::1",
                     "[::1]x", "[::2]", "::1", "user@localhost", "localhost@evil.example", "localhost/", "localhost, evil.example", "0.0.0.0"]:
            answer, body = self.server.get("/manifest.json", Host=host)
            self.assertEqual(answer.status, 403, host)
            self.assertNotIn(b"vog site", body)
        self.assertEqual(self.server.status("/", b"Host: localhost")[0], 403)  # two of them
        self.assertEqual(self.server.raw(b"GET / HTTP/1.1\r\nConnection: close\r\n\r\n")[9:12], b"403")

    def test_pages_of_one_other_origin_are_let_in(self):
        server = self.serve(self.site, "--port", "0", "--set", "allow-origin=https://example.org:8443")
        answer, _ = server.get("/manifest.json", Origin="https://example.org:8443")
        self.assertEqual(answer.getheader("Access-Control-Allow-Origin"), "https://example.org:8443")
        self.assertIn("Content-Range", answer.getheader("Access-Control-Expose-Headers"))
        answer, body = server.get("/manifest.json", "OPTIONS", Origin="https://example.org:8443", Access_Control_Request_Method="GET")
        self.assertEqual((answer.status, body), (200, b""))
        self.assertIn("Range", answer.getheader("Access-Control-Allow-Headers"))
        self.assertEqual(server.status("/", b"Content-Length: 0", method=b"POST")[0], 405)
        self.assertEqual(server.stop()[0], 0)


class Clients(ServeTest):
    def test_many_connections_at_once(self):
        """200 clients, more than threads: each is served."""
        results, data = [], (self.site / "chunks" / f"{CHUNK}.vogz").read_bytes()

        def fetch():
            results.append(self.server.status(f"/chunks/{CHUNK}.vogz") == (200, data))

        threads = [threading.Thread(target=fetch) for _ in range(200)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(results, [True] * 200)

    def test_silent_and_slow_clients_hold_nobody_up(self):
        clients = [self.server.connect() for _ in range(150)]
        for n, client in enumerate(clients):
            if n % 2:
                client.sendall(b"GET / HTTP/1.1\r\nHost: local")
        try:
            # 64 threads, for 2 s a silent client and 7 s a half head: 11 s.
            start = time.monotonic()
            self.assertEqual(self.server.status("/manifest.json")[0], 200)
            self.assertLess(time.monotonic() - start, 30)
        finally:
            for client in clients:
                client.close()

    def test_clients_that_stop_reading_hold_nobody_up(self):
        big = self.site / "big.vogz"
        with open(big, "wb") as file:
            file.truncate(1 << 28)
        self.addCleanup(big.unlink)
        clients = [self.server.connect() for _ in range(8)]
        for client in clients:
            client.sendall(b"GET /big.vogz HTTP/1.1\r\nHost: localhost\r\n\r\n")
        self.assertEqual(self.server.status("/manifest.json")[0], 200)
        for client in clients:
            client.close()
        self.assertEqual(self.server.status("/manifest.json")[0], 200)

    def test_a_file_that_shrinks_leaves_an_incomplete_response(self):
        big = self.site / "shrinking.vogz"
        with open(big, "wb") as file:
            file.truncate(1 << 28)
        self.addCleanup(big.unlink)
        with self.server.connect() as client:
            client.sendall(b"GET /shrinking.vogz HTTP/1.1\r\nHost: localhost\r\n\r\n")
            head = client.recv(1000)
            self.assertIn(b"Content-Length: 268435456", head)
            os.truncate(big, 1000)
            self.assertLess(len(received(client)), 1 << 28)


if __name__ == "__main__":
    run()
