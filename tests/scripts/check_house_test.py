#!/usr/bin/env python3
"""scripts/check_house.py on a small house of its own: clean it passes, and each rule broken once is the one
problem reported. Exits with 77, which ctest takes as skipped, where there is no ctags.
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

CHECK = pathlib.Path(__file__).resolve().parents[2] / "scripts/check_house.py"

# Everything that looks like a problem and is none.
CLEAN = {
    "include/vog/error.h": """\
// vog/error.h: the one exception type. The sum
// of what is wrong, in one line.
namespace vog {
/// text     with file and line
/// returns  true
/// cost     none
bool fails(int code);  ///< 0: none; of the last call
struct Error {};  ///< what() is one line
}
""",
    "include/vog/image.h": '// vog/image.h: pictures.\n#include "vog/error.h"\nnamespace vog { struct Image {}; }\n',
    "src/CMakeLists.txt": "# Nothing from apps/.\nadd_library(vog core/text.cpp)\n",
    "src/core/text.h": """\
// text.h: text.
namespace vog {
struct Hidden;
template <class T> struct Text {};
int width(int letter);
}
""",
    "src/core/text.cpp": """\
// text.cpp: letters.
#include "core/text.h"
#include "vog/error.h"
namespace vog {
namespace { struct Row {}; int rows = 0; }
int width(int letter = 'a') { return letter; }
}
""",
    "src/io/png.cpp": """\
// png.cpp: PNG images, https://example.org/cost  of it.
#include <png.h>
#include "core/text.h"
#include "vog/image.h"
namespace vog {
namespace { struct Row {}; int rows = 1; }
template <> struct Text<int> {};
int width(const Image& image) { return 1; }
int width(const Image& image, int border) { return border; }
}
""",
    "src/render/device/ray.h": "// device/ray.h: rays.\nnamespace vog::device { struct Ray {}; }\n",
    "apps/cli/main.cpp": "// main.cpp: the vog command.\nint main() {}\n",
    "apps/mpi/main.cpp": "// main.cpp: the vog-mpi command.\nint main() {}\n",
    "python/module.cpp": "// module.cpp: the module.\n",
    "python/vog/show.py": "# Shows.\n# cost  none\n",
}


class CheckHouse(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="vog-house-")
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for path, text in CLEAN.items():
            self.write(path, text)

    def write(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def add(self, path, line):
        """Appends a line to a file, which it makes if need be, with a proper opening; returns the line's number."""
        file = self.root / path
        text = file.read_text() if file.exists() else f"// {file.name}: rooms.\n"
        self.write(path, text + line + "\n")
        return len(text.splitlines()) + 1

    def check(self):
        done = subprocess.run([sys.executable, CHECK, "--root", self.root], capture_output=True, text=True)
        self.assertEqual(done.stderr, "")
        return done.returncode, [line for line in done.stdout.splitlines() if ", expected " in line], done.stdout

    def expect_only(self, *parts):
        code, problems, _ = self.check()
        self.assertEqual((code, len(problems)), (1, 1), problems)
        for part in parts:
            self.assertIn(part, problems[0])

    def test_a_clean_house_passes(self):
        code, problems, output = self.check()
        self.assertEqual((code, problems), (0, []), output)
        self.assertIn("includes: 5 includes, 0 problems", output)
        self.assertIn("names: 7 definitions, 0 problems", output)

    # Includes

    def test_an_include_from_a_higher_floor_fails(self):
        number = self.add("src/core/text.h", '#include "render/device/ray.h"')
        self.expect_only(f'src/core/text.h:{number}: includes "render/device/ray.h" of floor render', "expected core")

    def test_a_public_header_of_a_higher_floor_fails(self):
        number = self.add("src/core/text.h", "#include <vog/image.h>")
        self.expect_only(f'src/core/text.h:{number}: includes "vog/image.h" of floor data', "expected core")

    def test_a_public_header_that_includes_a_higher_one_fails(self):
        number = self.add("include/vog/error.h", '#include "vog/image.h"')
        self.expect_only(f'include/vog/error.h:{number}: includes "vog/image.h" of floor data', "expected core")

    def test_a_public_header_that_includes_a_private_one_fails(self):
        number = self.add("include/vog/image.h", '#include "core/text.h"')
        self.expect_only(f'include/vog/image.h:{number}: includes "core/text.h"', "public headers alone")

    def test_a_public_header_without_a_floor_fails(self):
        self.write("include/vog/unheard.h", "// vog/unheard.h: news.\n")
        self.expect_only("include/vog/unheard.h:1: on no floor", "PUBLIC_HEADERS")

    def test_a_folder_that_is_no_floor_fails(self):
        self.write("src/utils/text.h", "// text.h: text.\n")
        self.expect_only("src/utils/text.h:1: on no floor", "core, data, io")

    def test_an_include_from_apps_fails(self):
        number = self.add("src/io/png.cpp", '#include "../../apps/cli/commands.h"')
        self.expect_only(f'src/io/png.cpp:{number}: includes "../../apps/cli/commands.h"', "below include/ or src/")

    def test_rooms_of_the_command_in_a_circle_fail(self):
        for room, other in (("files", "help"), ("help", "options"), ("options", "files")):
            self.add(f"apps/cli/{room}/{room}.h", f'#include "{other}/{other}.h"')
        code, problems, _ = self.check()
        self.assertEqual((code, len(problems)), (1, 3), problems)
        self.assertIn('apps/cli/files/files.h:2: includes "help/help.h", expected no circle of rooms', problems)

    def test_a_source_from_apps_fails(self):
        number = self.add("src/CMakeLists.txt", "target_sources(vog PRIVATE ../apps/cli/terminal.cpp)")
        self.expect_only(f"src/CMakeLists.txt:{number}: takes", "no source from apps/")

    # Rooms

    def test_a_loose_file_fails(self):
        self.write("src/notes.txt", "later\n")
        self.expect_only("src/notes.txt:1: loose in src/")

    def test_a_room_of_seventeen_sources_fails_and_one_of_sixteen_does_not(self):
        for i in range(16):
            self.write(f"src/web/page/part{i}.js", "")
        self.assertEqual(self.check()[0], 0)
        self.write("src/web/page/page.css", "")
        self.expect_only("src/web/page:1: 17 sources", "at most 16")

    # Names

    def test_two_structs_of_one_name_fail(self):
        self.add("include/vog/image.h", "namespace vog { struct Conversion { int a; }; }")
        number = self.add("src/io/job.h", "namespace vog {\nstruct Conversion { float b; };\n}") + 1
        self.expect_only(f"src/io/job.h:{number}: struct vog::Conversion", "the struct at include/vog/image.h:4")

    def test_types_in_sources_count(self):
        self.add("src/core/text.cpp", "namespace vog { enum class Kind { a }; }")
        self.add("src/io/png.cpp", "namespace vog { using Kind = int; }")
        self.expect_only("src/io/png.cpp:11: typedef vog::Kind", "the enum at src/core/text.cpp:8")

    def test_two_functions_of_the_same_parameters_fail(self):
        self.add("src/io/png.cpp", "namespace vog { inline int width(int other) { return other + 1; } }")
        self.expect_only("src/io/png.cpp:11: function vog::width", "src/core/text.cpp:6")

    def test_a_function_and_a_variable_of_one_name_fail(self):
        self.add("src/core/text.cpp", "namespace vog { int height() { return 1; } }")
        self.add("src/io/png.cpp", "namespace vog { inline constexpr int height = 80; }")
        self.expect_only("src/io/png.cpp:11: variable vog::height", "the function at src/core/text.cpp:8")

    def test_names_in_nested_namespaces_of_python_and_apps_count(self):
        self.add("apps/cli/main.cpp", "namespace vog::shared { union Both { int a; float b; }; }")
        self.add("python/module.cpp", "namespace vog { namespace shared { class Both {}; } }")
        self.expect_only("python/module.cpp:2: class vog::shared::Both", "the union at apps/cli/main.cpp:3")

    # Prose

    def test_a_label_inside_a_comment_line_fails(self):
        for label in ("returns", "throws", "cost", "memory"):
            with self.subTest(label):
                text = (self.root / "src/core/text.h").read_text()
                number = self.add("src/core/text.h", f"/// volume  any {label}  one Gaussian")
                self.expect_only(f"src/core/text.h:{number}: '{label}  ' inside a comment line")
                self.write("src/core/text.h", text)

    def test_a_label_inside_a_python_comment_fails(self):
        number = self.add("python/vog/show.py", "show()  # shows it returns  nothing")
        self.expect_only(f"python/vog/show.py:{number}: 'returns  ' inside a comment line")

    def test_a_public_comment_with_a_late_subject_fails(self):
        for line in ("/// What is left.", "/// of each file one.", "/// Sums. Those are counted.",
                     "int x;  ///< it is one", "int y;  // Who reads."):
            with self.subTest(line):
                text = (self.root / "include/vog/image.h").read_text()
                number = self.add("include/vog/image.h", line)
                self.expect_only(f"include/vog/image.h:{number}: ", "no sentence that starts with what")
                self.write("include/vog/image.h", text)

    def test_a_second_line_that_starts_a_sentence_late_fails(self):
        number = self.add("include/vog/image.h", "/// Pictures.\n/// that are small.") + 1
        self.expect_only(f"include/vog/image.h:{number}: 'that are small.'")

    def test_a_wrong_opening_fails(self):
        for first in ("", "#pragma once", "// ray.h", "// ray.h: ", "// rays.h: rays.", "// ray.h: what rays are.",
                      "// core/ray.h: rays."):
            with self.subTest(first):
                self.write("src/core/ray.h", first + "\n")
                self.expect_only("src/core/ray.h:1: ", "expected '// ray.h: ' and a sentence")

    def test_a_public_opening_without_its_folder_fails(self):
        self.write("include/vog/image.h", "// image.h: pictures.\n")
        self.expect_only("include/vog/image.h:1: ", "expected '// vog/image.h: '")


if __name__ == "__main__":
    if not shutil.which("ctags"):
        print("skipped: no ctags here (scripts/install-deps.sh installs it)", file=sys.stderr)
        sys.exit(77)
    unittest.main()
