// film.cpp: ffmpeg as a process of its own, which reads raw pictures from a socket. No shell has a part in it, and
// names of files are arguments of their own.
#include "files/film.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

#include "files/inputs.h"
#include "vog/error.h"

extern char** environ;  // NOLINT: POSIX has no header for it

namespace vog::cli {

namespace fs = std::filesystem;

namespace {

/// Arguments of ffmpeg for a film of raw pictures on its standard input.
std::vector<std::string> encoder_arguments(int width, int height, double per_second, bool webm,
                                           const fs::path& output) {
    std::vector<std::string> list{"ffmpeg", "-hide_banner", "-nostdin", "-loglevel", "error", "-y"};
    const auto add = [&](std::initializer_list<std::string> more) {
        list.insert(list.end(), more);
    };
    add({"-f", "rawvideo", "-pixel_format", "rgb24"});
    add({"-video_size", fmt::format("{}x{}", width, height)});
    add({"-framerate", fmt::format("{:.17g}", per_second), "-i", "pipe:0"});
    // Luma and chroma by BT.709, and said so: players take other colours for granted where a film is silent.
    add({"-vf", "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p"});
    add({"-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709"});
    add({"-color_range", "tv"});
    // Constant quality: 40 dB and more for smoke (docs/cameras.md).
    if (webm)
        add({"-c:v", "libvpx-vp9", "-b:v", "0", "-crf", "20", "-row-mt", "1", "-cpu-used", "4"});
    else
        add({"-c:v", "libx264", "-crf", "16", "-movflags", "+faststart"});
    // With its protocol, so that no letter of a name has a meaning of its own.
    add({"-f", webm ? "webm" : "mp4", "file:" + fs::absolute(output).string()});
    return list;
}

/// Bytes of a picture with even sides, as films have: the last row and column may be there twice.
std::vector<std::uint8_t> even_bytes(const Image& picture) {
    const auto width = static_cast<std::size_t>(picture.width);
    std::vector<std::uint8_t> bytes = image_bytes(picture, false);
    if (picture.width % 2 == 0 && picture.height % 2 == 0) return bytes;
    std::vector<std::uint8_t> even;
    for (int row = 0; row < picture.height + picture.height % 2; ++row) {
        const auto from =
            bytes.begin() +
            static_cast<std::ptrdiff_t>(
                3 * width * static_cast<std::size_t>(std::min(row, picture.height - 1)));
        const auto to = from + static_cast<std::ptrdiff_t>(3 * width);
        even.insert(even.end(), from, to);
        if (picture.width % 2) even.insert(even.end(), to - 3, to);
    }
    return even;
}

/// Text of a file from its beginning, up to some bytes.
std::string beginning(int file) {
    std::string text(4096, '\0');
    const ssize_t count = ::pread(file, text.data(), text.size(), 0);
    text.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    return text;
}

/// A file without a name, for messages of a process.
int nameless_file() {
    std::string name = (fs::temp_directory_path() / "vog-XXXXXX").string();
    const int file = ::mkostemp(name.data(), O_CLOEXEC);
    if (file < 0)
        throw Error(
            fmt::format("{}: cannot write: {}", name, std::generic_category().message(errno)));
    (void)::unlink(name.c_str());
    return file;
}

}  // namespace

std::string program_path(const std::string& name) {
    const char* folders = std::getenv("PATH");
    std::istringstream list(folders ? folders : "");
    for (std::string folder; std::getline(list, folder, ':');) {
        const fs::path path = fs::path(folder.empty() ? "." : folder) / name;
        std::error_code code;
        if (fs::is_regular_file(path, code) && ::access(path.c_str(), X_OK) == 0) return path;
    }
    return {};
}

bool is_film(const std::string& output) {
    const std::string extension = extension_of(output);
    return extension == ".mp4" || extension == ".webm";
}

Film::Film(const std::string& file, double per_second)
    : file_(file), program_(program_path("ffmpeg")), per_second_(per_second) {
    if (program_.empty())
        throw Error(
            fmt::format("{}: films need the program ffmpeg, which is not installed; -o FOLDER/ "
                        "writes the pictures as PNG files",
                        file));
}

Film::~Film() {
    close_input();
    if (process_ > 0) {
        (void)::kill(process_, SIGKILL);
        (void)::waitpid(process_, nullptr, 0);
    }
    if (messages_ >= 0) (void)::close(messages_);
}

void Film::close_input() {
    if (input_ >= 0) (void)::close(std::exchange(input_, -1));
}

void Film::start(int width, int height) {
    std::error_code code;
    const bool link = fs::is_symlink(file_, code) && fs::is_regular_file(file_, code);
    beside_.emplace(link ? fs::canonical(file_) : fs::path(file_));
    messages_ = nameless_file();
    // A socket in place of a pipe: where ffmpeg has ended, send() says so without a signal.
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
        throw Error(fmt::format("{}: {}", file_, std::generic_category().message(errno)));
    input_ = ends[0];
    std::vector<std::string> arguments = encoder_arguments(
        width, height, per_second_, extension_of(file_) == ".webm", beside_->path());
    std::vector<char*> words;
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
    ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    ::posix_spawn_file_actions_adddup2(&actions, messages_, STDERR_FILENO);
    const int error =
        ::posix_spawn(&process_, program_.c_str(), &actions, nullptr, words.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    (void)::close(ends[1]);
    if (error == 0) return;
    process_ = -1;
    throw Error(fmt::format("{}: {}", program_, std::generic_category().message(error)));
}

void Film::fail() {
    close_input();
    if (process_ > 0) (void)::waitpid(std::exchange(process_, -1), nullptr, 0);
    std::string text = beginning(messages_);
    text = text.substr(0, text.find('\n'));
    throw Error(fmt::format("{}: ffmpeg failed: {}", file_,
                            text.empty() ? "it ended without a message" : text));
}

void Film::add(const Image& picture) {
    if (!opaque(picture))
        throw Error(fmt::format(
            "{}: films have no transparency; choose another --background, or -o FOLDER/", file_));
    const std::vector<std::uint8_t> bytes = even_bytes(picture);
    if (pictures_ == 0)
        start(picture.width + picture.width % 2, picture.height + picture.height % 2);
    for (std::size_t sent = 0; sent < bytes.size();) {
        const ssize_t count =
            ::send(input_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail();
        sent += static_cast<std::size_t>(count);
    }
    ++pictures_;
}

void Film::finish() {
    close_input();
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fail();
    beside_->rename();
}

}  // namespace vog::cli
