#!/usr/bin/env python3
"""Plans of streamed pages, folders that `vog page -o FOLDER/` writes: what is requested in which order, what is drawn at rest, detail,
steps in time, limits of memory. In Node.js, without a browser: streaming_test.py has that.

VOG_COMMAND names the command. Exits with 77, which ctest takes as skipped, where there is no Node.js.
"""
import random

from page_test_case import run, vog, write_model
from quantity_test_case import write_flow
from streaming_test_case import DUST, SMALL, NodeSiteTest, write_dust


class Plans(NodeSiteTest):
    @classmethod
    def make(cls):
        write_dust(cls.folder / "dust.ply")
        vog("page", "dust.ply", "-o", "site/", "--tf", "gray")

    def test_the_coarsest_chunk_comes_first_and_is_small(self):
        server = self.start()
        self.assertEqual(server.paths[:2], ["/", "/manifest.json"])
        root = self.root()
        self.assertEqual(server.chunks("")[0], f"/chunks/{root['name']}.vogz")
        self.assertLessEqual((self.folder / "site/manifest.json").stat().st_size + root["bytes"][0], 200_000)
        self.assertEqual(self.loaded, sum((self.folder / "site" / path[1:]).stat().st_size for path in server.paths[1:]))
        self.assertEqual(len(server.paths), len(set(server.paths)))

    def test_nothing_else_is_asked_for_before_the_first_picture(self):
        seen = []

        def slow(body):
            seen.append(list(self.server.paths))
            return body
        self.start(delay_s=0.2, answers={f"{self.root()['name']}.vogz": slow})
        self.assertEqual(len(seen), 1)
        self.assertEqual(len([path for path in seen[0] if path.startswith("/chunks/")]), 1)

    def test_the_picture_at_rest_is_that_of_the_whole_model(self):
        self.start(size=(320, 240))
        for view in ("{}", self.near(0.4), self.near(0.2), "{pixelError: 0.5}", "{camera: withOtherProjection(vog.state.camera)}", self.near(0.05)):
            self.change(view)
            self.expect_whole()

    def test_a_small_picture_takes_few_chunks_and_a_near_view_more(self):
        server = self.start(size=(40, 30), fragment="#subframes=1&embed&error=8")
        first, few = self.drawn, len(server.chunks())
        self.assertLess(first, DUST)
        self.assertIn("px", self.value("stream.textContent"))
        self.resize(320, 240)
        self.change(self.near(0.3))
        self.assertGreater(len(server.chunks()), few)

    def test_what_the_rest_hides_comes_last(self):
        rng, rows = random.Random(6), []
        for _ in range(DUST):
            rows += [*(rng.uniform(-1, 1) for _ in range(3)), 0.03, 0.03, 0.03, 1]
        write_model(self.folder / "block.ply", rows)
        vog("page", "block.ply", "-o", "block/", "--tf", "gray")
        bound = "[vog.source.cut.shown, vog.source.cut.error, stream.textContent.includes('full')]"
        self.start("block", size=(320, 240), fragment="#subframes=1&embed&exposure=0.1&most=40000")
        self.change(self.near(0.1))  # from inside: what is far lies behind the rest
        faint = self.value(bound)
        self.change({"exposure": 8})
        opaque = self.value(bound)
        # What memory leaves out is hidden by more than it was.
        self.assertEqual([faint[2], opaque[2]], [True, True])
        self.assertLess(opaque[0], 0.1 * faint[0])
        self.expect_whole("block.ply")
        self.change({"show": "column"})  # a sum hides nothing
        self.assertEqual(*self.value(bound)[:2])
        # With room for it, all that is in view has its detail.
        self.change({"show": "T", "most": None})
        self.assertEqual(self.value(bound), [1, 1, False])
        self.assertEqual(self.drawn, DUST)

    def test_detail_is_an_error_in_pixels(self):
        self.start(size=(160, 120), fragment="#subframes=1&error=32")
        coarse = self.drawn
        self.assertLess(coarse, DUST)
        self.assertEqual(self.value("vog.source.detail().value"), 0)
        self.assertIn("error=32", self.value("writeLink(vog.page, vog.state, {streamed: true, size: [3, 2], background: vog.page.background})"))
        for _ in range(12):
            self.value("vog.change(vog.source.detailed(vog.source.detail().value + 1))")
        self.settle()
        self.assertEqual(self.value("vog.state.pixelError"), 0.5)
        self.assertEqual(self.value("vog.source.detail().value"), self.value("vog.source.detail().most"))
        self.assertGreater(self.drawn, coarse)
        self.assertEqual(self.value("vog.source.detail().text"), f"{self.drawn:,} Gaussians")

    def test_slow_frames_make_motion_coarser_and_rest_is_whole(self):
        self.start(size=(320, 240))
        whole = self.drawn
        self.value("for (let n = 0; n < 12; ++n) vog.source.frameTook(1000, true)")
        self.assertLess(self.value("vog.source.now(true).count"), whole)
        self.assertEqual(self.value("vog.source.now(false).count"), whole)
        self.value("for (let n = 0; n < 60; ++n) vog.source.frameTook(5, true)")
        self.assertEqual(self.value("vog.source.now(true).count"), whole)

    def test_memory_stays_within_its_limits_in_a_flight(self):
        server = self.start(fragment="#subframes=1&error=0.5&memory=3.2&most=52000&show=column", size=(160, 120))
        self.value("""{
            vog.peak = {bytes: 0, gaussians: 0};
            const { show } = vog.source.view;
            vog.source.view.show = (status) => {
                const used = vog.source.store.used();
                for (const key of ['bytes', 'gaussians']) vog.peak[key] = Math.max(vog.peak[key], used[key]);
                show(status);
            };}""")
        first = self.value("vog.state.camera")
        for n in range(8):
            target = self.parts_of_root()[n % len(self.parts_of_root())]["box"]
            at = [0.5 * (target[k] + target[3 + k]) + self.manifest()["models"][0]["origin"][k] for k in range(3)]
            self.change({"camera": {**first, "at": at, "eye": [at[0], at[1], at[2] + 0.3]}})
        self.change({"camera": first})
        peak = self.value("vog.peak")
        self.assertLessEqual(peak["bytes"], 3.2e6)
        self.assertLessEqual(peak["gaussians"], 52000)
        self.assertGreater(peak["gaussians"], 40000)
        self.assertIn("memory full", self.value("stream.textContent"))
        self.assertGreater(len(server.paths), len(set(server.paths)))  # what had to go was asked for again

    def test_what_has_been_seen_is_not_asked_for_again(self):
        server = self.start(size=(160, 120))
        first = self.value("vog.state.camera")
        self.change(self.near(0.2))
        asked = len(server.paths)
        self.change({"camera": first})
        self.change(self.near(0.2))
        self.assertEqual(len(server.paths), asked)


class Fields(NodeSiteTest):
    @classmethod
    def make(cls):
        write_flow(cls.folder / "flow.ply", 9000)
        vog("page", "flow.ply", "-o", "flow/", "--precise")

    def test_files_of_fields_come_when_they_are_shown(self):
        server = self.start("flow")
        self.assertEqual(server.chunks(".0") + server.chunks(".1"), [])
        self.change({"show": "mean"})
        self.assertEqual(len(server.chunks(".0")), len(server.chunks(".vogz")))
        self.assertEqual(server.chunks(".1"), [])
        self.change({"field": 1, "part": "view"})
        vectors = len(server.chunks(".1"))
        self.assertEqual(vectors, len(server.chunks(".vogz")))
        for part in ("x", "y", "z", "magnitude"):
            self.change({"part": part})
        self.assertEqual(len(server.chunks(".1")), vectors)


class Steps(NodeSiteTest):
    @classmethod
    def make(cls):
        for n in range(4):
            write_dust(cls.folder / f"step{n}.ply", 3000, seed=3, shift=0.02 * n)
        vog("page", "step?.ply", "-o", "steps/", "--site", "--tf", "gray")

    def names(self, n):
        return f"/chunks/{self.manifest('steps')['models'][n]['root']['name']}.vogz"

    def test_the_next_steps_are_fetched_ahead(self):
        server = self.start("steps", fragment="#subframes=1")
        self.until("vog.source.requests.toCome.length === 0")
        self.assertIn(self.names(1), server.paths)
        self.assertIn(self.names(2), server.paths)
        self.assertNotIn(self.names(3), server.paths)
        self.until("vog.source.isReady(1)")
        asked = [path for path in server.paths if path != self.names(3)]
        self.change({"model": 1})
        self.until("vog.source.requests.toCome.length === 0")
        self.assertIn(self.names(3), server.paths)
        self.assertEqual([path for path in server.paths if path != self.names(3)], asked)
        self.expect_whole("step1.ply")

    def test_a_step_that_is_missing_is_passed_over(self):
        self.start("steps", fragment="#subframes=1", size=SMALL, answers={self.names(1): 404})
        self.until("notice.textContent.includes('404')")
        self.assertIn("cannot be shown", self.notice())
        self.assertEqual(self.failure(), "")
        self.assertTrue(self.value("vog.source.isReady(1)"))
        self.change({"model": 2})
        self.expect_whole("step2.ply")


if __name__ == "__main__":
    run()
