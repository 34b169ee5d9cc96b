#!/usr/bin/env python3
"""vog serve: files, types, caches, ranges; ports, hosts, options; its end. VOG_COMMAND names the command."""
import http.client
import os
import signal
import subprocess
import time
import unittest
from pathlib import Path

from serve_test_case import CHUNK, SECONDS, ServeTest, VOG, run


class Answers(ServeTest):
    def test_the_address_is_one_line(self):
        self.assertRegex(self.server.url, r"^http://127\.0\.0\.1:\d+/$")

    def test_files_have_their_bytes_and_types(self):
        for path, file, kind in [
            ("/", "index.html", "text/html; charset=utf-8"),
            ("/index.html", "index.html", "text/html; charset=utf-8"),
            ("/index.html?version=2&x=../y", "index.html", "text/html; charset=utf-8"),
            ("/manifest.json", "manifest.json", "application/json"),
            (f"/chunks/{CHUNK}.vogz", f"chunks/{CHUNK}.vogz", "application/octet-stream"),
            (f"/chunks/{CHUNK}.0", f"chunks/{CHUNK}.0", "application/octet-stream"),
            (f"/chunks/{CHUNK}.json", f"chunks/{CHUNK}.json", "application/json"),
            ("/a%20b%2B%c3%BC.txt", "a b+ü.txt", "text/plain; charset=utf-8"),
            ("/empty.css", "empty.css", "text/css; charset=utf-8"),
        ]:
            answer, body = self.server.get(path)
            expected = (self.site / file).read_bytes()
            self.assertEqual((answer.status, body), (200, expected), path)
            self.assertEqual(answer.getheader("Content-Type"), kind)
            self.assertEqual(answer.getheader("X-Content-Type-Options"), "nosniff")
            self.assertIsNone(answer.getheader("Access-Control-Allow-Origin"))
            head, body = self.server.get(path, "HEAD")
            self.assertEqual((head.status, body), (200, b""))
            self.assertEqual(head.getheader("Content-Length"), str(len(expected)))
            self.assertEqual(head.getheader("Content-Type"), kind)

    def test_chunks_named_by_content_stay_in_caches_and_the_page_does_not(self):
        cache = lambda path: self.server.get(path)[0].getheader("Cache-Control")
        for path in ["/", "/manifest.json", "/chunks/other.vogz", "/nothing"]:
            self.assertEqual(cache(path), "no-cache", path)
        for end in ["vogz", "0", "json"]:
            self.assertIn("immutable", cache(f"/chunks/{CHUNK}.{end}"))

    def test_an_unchanged_file_is_not_sent_again(self):
        tag = self.server.get("/manifest.json")[0].getheader("ETag")
        answer, body = self.server.get("/manifest.json", If_None_Match=tag)
        self.assertEqual((answer.status, body), (304, b""))
        manifest = self.site / "manifest.json"
        text = manifest.read_text()
        self.addCleanup(manifest.write_text, text)
        time.sleep(0.02)  # more than a tick of the file system's clock, 4 ms
        manifest.write_text(text.replace("1", "2"))
        answer, body = self.server.get("/manifest.json", If_None_Match=tag)
        self.assertEqual((answer.status, body), (200, manifest.read_bytes()))

    def test_ranges(self):
        path, data = f"/chunks/{CHUNK}.vogz", (self.site / "chunks" / f"{CHUNK}.vogz").read_bytes()
        size = len(data)
        for text, first, end in [("0-0", 0, 1), ("5-104", 5, 105), ("100000-", 100_000, size), ("-7", size - 7, size),
                                 ("199999-99999999", size - 1, size), ("-99999999", 0, size)]:
            answer, body = self.server.get(path, Range=f"bytes={text}")
            self.assertEqual((answer.status, body), (206, data[first:end]), text)
            self.assertEqual(answer.getheader("Content-Range"), f"bytes {first}-{end - 1}/{size}")
            self.assertEqual(answer.getheader("Content-Length"), str(end - first))
            head, body = self.server.get(path, "HEAD", Range=f"bytes={text}")
            self.assertEqual((head.getheader("Content-Length"), body), (str(end - first), b""))
        for text in [f"{size}-", f"{size + 5}-{size + 9}", "-0"]:
            answer, body = self.server.get(path, Range=f"bytes={text}")
            self.assertEqual((answer.status, body, answer.getheader("Content-Range")), (416, b"", f"bytes */{size}"), text)
        # Several ranges: the whole file, as the standard allows.
        for text in ["bytes=0-1,5-6", f"bytes=0-1,{size}-", "bytes=" + "0-0," * 1500 + "0-0"]:
            answer, body = self.server.get(path, Range=text)
            self.assertEqual((answer.status, body), (200, data), text[:40])
        # cpp-httplib refuses other units and malformed ranges.
        for text in ["bytes=7-3", "bytes=", "bytes=a-b", "items=0-1", "bytes=-", "bytes=1" + "0" * 30 + "-", "bytes=0x1-2", "bytes=-5-6"]:
            answer, body = self.server.get(path, Range=text)
            self.assertEqual((answer.status, body), (416, b""), text[:40])
        self.assertEqual(self.server.get("/nothing", Range="bytes=500-")[0].status, 404)
        self.assertEqual(self.server.get("/empty.css", Range="bytes=0-")[0].status, 416)

    def test_a_range_of_other_content_is_the_whole(self):
        tag = self.server.get("/manifest.json")[0].getheader("ETag")
        self.assertEqual(self.server.get("/manifest.json", Range="bytes=0-1", If_Range=tag)[0].status, 206)
        self.assertEqual(self.server.get("/manifest.json", Range="bytes=0-1", If_Range='"other"')[0].status, 200)

    def test_a_connection_has_many_requests(self):
        client = http.client.HTTPConnection("127.0.0.1", self.server.port, timeout=SECONDS)
        client.connect()
        first = client.sock
        for _ in range(100):
            client.request("GET", "/manifest.json")
            self.assertEqual(client.getresponse().read(), (self.site / "manifest.json").read_bytes())
        self.assertIs(client.sock, first)
        client.close()
        self.assertIn(b" 200 ", self.server.raw(b"GET / HTTP/1.0\r\nHost: localhost\r\n\r\n"))

    def test_a_single_file_is_served_by_itself(self):
        (self.folder / "a page.html").write_text("<p>")
        server = self.serve(self.folder / "a page.html", "--port", "0")
        self.assertTrue(server.url.endswith("/a%20page.html"))
        self.assertEqual(server.status("/a%20page.html"), (200, b"<p>"))
        for path in ["/", "/secret.txt", "/site/index.html", "/a%20page.html/", "/site/../a%20page.html"]:
            self.assertEqual(server.status(path)[0], 404, path)
        self.assertEqual(server.stop()[0], 0)

    def test_a_compact_file_with_levels_has_a_page(self):
        def vog(*words):
            subprocess.run([VOG, *words], check=True, stdout=subprocess.DEVNULL, cwd=self.folder)
        vog("sample", "cloud", "c.vdb", "--size", "64")
        vog("convert", "c.vdb", "-o", "c.ply")
        vog("pack", "c.ply", "-o", "a file.vogz", "--hierarchy", "--deflate")
        vog("pack", "c.ply", "-o", "plain.vogz")
        data = (self.folder / "a file.vogz").read_bytes()
        server = self.serve(self.folder / "a file.vogz", "--port", "0")
        self.assertTrue(server.url.endswith(f":{server.port}/"), server.url)
        answer, page = server.get("/")
        self.assertEqual((answer.status, answer.getheader("Content-Type")), (200, "text/html; charset=utf-8"))
        self.assertIn(b'"file":"a%20file.vogz"', page)
        self.assertEqual(server.status("/a%20file.vogz"), (200, data))
        answer, body = server.get("/a%20file.vogz", Range="bytes=5-9")
        self.assertEqual((answer.status, body), (206, data[5:10]))
        for path in ["/index.html", "/page.html", "/c.ply"]:
            self.assertEqual(server.status(path)[0], 404, path)
        self.assertEqual(server.stop(), (0, "", ""))
        server = self.serve(self.folder / "plain.vogz", "--port", "0")
        self.assertTrue(server.url.endswith("/plain.vogz"))
        self.assertEqual(server.status("/")[0], 404)
        code, _, errors = server.stop()
        self.assertEqual((code, errors.count("\n")), (0, 1))
        self.assertIn("--hierarchy --deflate", errors)


class Ends(ServeTest):
    def test_signals_end_it_well(self):
        for number in [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]:
            server = self.serve(self.site, "--port", "0")
            idle = server.connect()
            busy = server.connect()
            busy.sendall(b"GET / HT")
            start = time.monotonic()
            self.assertEqual(server.stop(number), (0, "", ""))
            self.assertLess(time.monotonic() - start, 5)
            idle.close()
            busy.close()

    def test_at_once_after_its_start(self):
        for _ in range(5):
            self.assertEqual(self.serve(self.site, "--port", "0").stop(), (0, "", ""))

    def refusal(self, *words, code=1, **settings):
        done = subprocess.run([VOG, "serve", *map(str, words)], capture_output=True, text=True, timeout=SECONDS, **settings)
        self.assertEqual((done.returncode, done.stdout), (code, ""), done.stderr)
        lines = [line for line in done.stderr.splitlines() if line != "Run with --help for usage."]
        self.assertEqual(len(lines), 1, done.stderr)
        return lines[0]

    def test_a_port_in_use_is_refused_or_the_next_one_is(self):
        port = self.server.port
        self.assertIn("the port is in use; choose another (0: any free port)", self.refusal(self.site, "--port", port))
        # Without --port: 8080, or another that is named. One of two servers at least does not get the first.
        one, two = self.serve(self.site), self.serve(self.site)
        self.assertNotEqual(one.port, two.port)
        self.assertEqual(two.status("/")[0], 200)
        self.assertEqual(one.stop()[0], 0)
        code, _, err = two.stop()
        self.assertEqual((code, err), (0, f"vog: note: port 8080 is in use; using port {two.port}\n"))

    def test_a_port_is_free_again_after_the_server(self):
        server = self.serve(self.site, "--port", "0")
        self.assertEqual(server.get("/")[0].status, 200)
        self.assertEqual(server.stop()[0], 0)
        self.assertEqual(self.serve(self.site, "--port", server.port).stop()[0], 0)

    def test_what_is_no_site_is_refused(self):
        empty, page = self.folder / "empty", self.folder / "half"
        empty.mkdir()
        page.mkdir()
        (page / "index.html").write_text("")
        (self.folder / "picture.png").write_text("")
        self.assertIn("absent: no such folder", self.refusal(self.folder / "absent"))
        self.assertRegex(self.refusal(empty), "without index.html and manifest.json; expected a site .vog page MODEL -o site. writes one.")
        self.assertIn("without manifest.json;", self.refusal(page))
        self.assertIn("expected a site", self.refusal(self.folder / "picture.png"))
        self.assertIn("site is required", self.refusal(code=2))

    def test_options_out_of_range_are_refused(self):
        for words in [["--port", "65536"], ["--port", "-1"], ["--port", "x"], ["--set", "allow-origin=example.org"], ["--set", "allow-origin=https://"],
                      ["--set", "allow-origin=https://a/b"], ["--set", "allow-origin=https://a\r\nX: y"], ["--set", "allow-origin=http://a, http://b"]]:
            self.refusal(self.site, *words, code=2)
        self.assertIn("expected a value behind the =", self.refusal(self.site, "--set", "host=", "--port", "0", code=2))
        for host in ["no.such.host.invalid", "300.1.1.1", "192.0.2.1"]:  # the last: of documents, no machine's
            self.assertIn("--set host=", self.refusal(self.site, "--set", f"host={host}", "--port", "0"))

    @unittest.skipUnless(os.geteuid() == 0, "needs root, to become a user who may not")
    def test_a_port_of_the_system_is_refused(self):
        if int(Path("/proc/sys/net/ipv4/ip_unprivileged_port_start").read_text()) <= 80:
            self.skipTest("port 80 is open to every user here")
        os.chmod(self.folder, 0o755)
        try:
            self.assertIn("no permission", self.refusal(self.site, "--port", "80", user=65534, group=65534, extra_groups=[]))
        except PermissionError:
            self.skipTest(f"{VOG} is out of that user's reach")

    def test_a_host_beyond_loopback_is_warned_of(self):
        server = self.serve(self.site, "--set", "host=0.0.0.0", "--port", "0")
        self.assertEqual(server.get("/", Host="a.name.of.this.machine")[0].status, 200)
        code, _, err = server.stop()
        self.assertEqual(code, 0)
        self.assertRegex(err, r"^vog: note: --set host=0\.0\.0\.0: every machine that reaches this one can read .*site\n$")
        self.assertEqual(self.serve(self.site, "--set", "host=127.0.0.2", "--port", "0").stop(), (0, "", ""))

    def test_requests_are_printed_on_demand(self):
        server = self.serve(self.site, "--port", "0", "--verbose")
        server.status("/manifest.json")
        server.status("/%1b[2J")
        server.status("/", b"Content-Length: 0", method=b"POST")
        lines = server.stop()[2].splitlines()
        self.assertEqual(lines, ["vog: note: 200 GET /manifest.json", "vog: note: 404 GET /%1b[2J", "vog: note: 405 POST /"])

    def test_the_browser_is_opened_on_demand(self):
        programs = self.folder / "programs"
        programs.mkdir()
        opened = programs / "opened"
        (programs / "xdg-open").write_text(f'#!/bin/sh\necho "$@" > {opened}.new\nmv {opened}.new {opened}\n')
        (programs / "xdg-open").chmod(0o755)
        server = self.serve(self.site, "--port", "0", "--open", env={**os.environ, "PATH": f"{programs}:{os.environ['PATH']}"})
        until = time.monotonic() + SECONDS
        while not opened.exists() and time.monotonic() < until:
            time.sleep(0.05)
        self.assertEqual(opened.read_text(), server.url + "\n")
        self.assertEqual(server.stop(), (0, "", ""))
        server = self.serve(self.site, "--port", "0", "--open", env={**os.environ, "PATH": str(self.folder)})
        self.assertIn("xdg-open is not installed", server.stop()[2])


if __name__ == "__main__":
    run()
