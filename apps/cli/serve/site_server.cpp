// site_server.cpp: responses and end of the server, by the public interface of cpp-httplib.
#include "serve/site_server.h"

#include "vog/error.h"

#ifdef VOG_HTTPLIB

#include <fmt/format.h>
#include <httplib.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <future>
#include <regex>
#include <utility>

namespace vog::cli {

namespace {

using std::chrono::milliseconds;

constexpr int kNextPorts = 20;  // tried after the first
// Browsers open six connections to a server. A thread waits for the network or the disk nearly always.
constexpr std::size_t kThreads = 64;
// Until a silent connection leaves its thread to another; browsers open the next one as they need it.
constexpr int kIdleSeconds = 2;
constexpr std::size_t kLargestBody = 8192;  // read before its refusal, bytes

volatile std::sig_atomic_t ending = 0;  // set by a signal

/// Has signals end the server. Those that the parent has made us ignore, such as nohup's, stay ignored.
void end_at_signals() {
    for (const int number : {SIGINT, SIGTERM, SIGHUP})
        if (std::signal(number, [](int) { ending = 1; }) == SIG_IGN)
            (void)std::signal(number, SIG_IGN);
}

/// Whether a Host field names this machine's loopback, with any port, as tunnels have others. Pages of
/// another name are thus refused even if their name server gives it this address (DNS rebinding).
bool is_loopback(const std::string& host) {
    static const std::regex names(R"((localhost|127\.\d+\.\d+\.\d+|\[::1\])(:\d*)?)",
                                  std::regex::icase);
    return std::regex_match(host, names);
}

/// Sends a part of a file in pieces.
httplib::ContentProvider provider_of(const SiteFile& file, std::uint64_t first) {
    return [file, first](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
        std::array<char, 1 << 16> buffer;
        const ssize_t count =
            ::pread(::fileno(file.file.get()), buffer.data(), std::min(length, buffer.size()),
                    static_cast<off_t>(first + offset));
        // A file that has become shorter: the response stays incomplete, which its length shows.
        return count > 0 && sink.write(buffer.data(), static_cast<std::size_t>(count));
    };
}

/// The whole file, or the one range that is requested.
/// ranges  first and last byte of each; -1: not given
void send_file(const SiteFile& file, const httplib::Ranges& ranges, httplib::Response& response) {
    const auto size = static_cast<std::int64_t>(file.size);
    std::int64_t first = 0, end = size;
    response.status = 200;
    if (ranges.size() == 1) {
        const auto [from, to] = ranges.front();
        first = from >= 0 ? from : std::max<std::int64_t>(0, size - to);
        if (from >= 0 && to >= 0) end = std::min<std::int64_t>(to, size - 1) + 1;
        response.status = first < end ? 206 : 416;
        response.set_header("Content-Range",
                            first < end ? fmt::format("bytes {}-{}/{}", first, end - 1, size)
                                        : fmt::format("bytes */{}", size));
    }
    if (first < end)
        response.set_content_provider(static_cast<std::size_t>(end - first), file.type,
                                      provider_of(file, static_cast<std::uint64_t>(first)));
    else
        response.set_header("Content-Type", file.type);
}

/// Answers a GET or HEAD request for a file.
void answer(const SiteFolder& folder, const httplib::Request& request, httplib::Ranges ranges,
            httplib::Response& response) {
    const std::optional<SiteFile> file = folder.open(request.path);
    response.set_header("Cache-Control", file && file->immutable
                                             ? "public, max-age=31536000, immutable"
                                             : "no-cache");
    if (!file) {
        response.status = 404;
        response.set_content("no such file\n", "text/plain; charset=utf-8");
        return;
    }
    response.set_header("ETag", file->tag);
    response.set_header("Accept-Ranges", "bytes");
    if (request.get_header_value("If-None-Match").find(file->tag) != std::string::npos) {
        response.status = 304;
        response.set_header("Content-Length", std::to_string(file->size));
        return;
    }
    // A range of other content than the client has begun with is answered by the whole.
    if (request.has_header("If-Range") && request.get_header_value("If-Range") != file->tag)
        ranges.clear();
    send_file(*file, ranges, response);
}

/// Permission for pages of another origin, which they request before a range.
void answer_preflight(httplib::Response& response) {
    response.status = 200;
    response.set_header("Access-Control-Allow-Methods", "GET, HEAD");
    response.set_header("Access-Control-Allow-Headers", "Range, If-None-Match, If-Range");
    // Required by Chromium for pages of the internet that read from this machine.
    response.set_header("Access-Control-Allow-Private-Network", "true");
}

/// Sets limits and answers of a server.
/// loopback  reached from this machine alone
void set_up(httplib::Server& server, const SiteFolder& folder, const ServerOptions& options,
            bool loopback) {
    server.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
    server.set_keep_alive_timeout(kIdleSeconds).set_keep_alive_max_count(1000);
    server.set_payload_max_length(kLargestBody);
    // Head and body of a response are two sends: without this the second waits 40 ms for the client.
    server.set_tcp_nodelay(true);
    // The library's own options let a second server listen at the same port.
    server.set_socket_options([](socket_t socket) {
        const int yes = 1;
        (void)::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    const bool open = !options.allow_origin.empty();
    httplib::Headers headers = {
        {"X-Content-Type-Options", "nosniff"},
        {"Cross-Origin-Resource-Policy", open ? "cross-origin" : "same-origin"}};
    if (open) {
        headers.emplace("Access-Control-Allow-Origin", options.allow_origin);
        headers.emplace("Access-Control-Expose-Headers", "Content-Range, ETag");
    }
    server.set_default_headers(std::move(headers));
    server.set_pre_routing_handler([&folder, open, loopback](const httplib::Request& request,
                                                             httplib::Response& response) {
        const bool preflight = open && request.method == "OPTIONS";
        // Bodies of other methods are read by the library, before it finds no handler.
        if (request.method != "GET" && request.method != "HEAD" && !preflight)
            return httplib::Server::HandlerResponse::Unhandled;
        // send_file() serves ranges: cpp-httplib 0.11 applies them to refusals as well, and gives those that
        // end beyond the file a wrong length.
        httplib::Ranges ranges =
            std::exchange(const_cast<httplib::Request&>(request).ranges, httplib::Ranges{});
        if (loopback && (request.get_header_value_count("Host") != 1 ||
                         !is_loopback(request.get_header_value("Host")))) {
            response.status = 403;
            response.set_content("expected a Host of this machine, as localhost\n", "text/plain");
        } else if (preflight) {
            answer_preflight(response);
        } else {
            answer(folder, request, std::move(ranges), response);
        }
        return httplib::Server::HandlerResponse::Handled;
    });
    server.set_error_handler([](const httplib::Request& request, httplib::Response& response) {
        if (response.status != 404 || request.method == "GET" || request.method == "HEAD") return;
        response.status = 405;
        response.set_header("Allow", "GET, HEAD");
    });
    if (options.on_request)
        server.set_logger(
            [&options](const httplib::Request& request, const httplib::Response& response) {
                options.on_request(
                    fmt::format("{} {} {}", response.status, request.method, request.target));
            });
}

/// Listens at the port that was requested, or at the next free one.
/// returns  the port
int bind(httplib::Server& server, const ServerOptions& options) {
    errno = 0;
    for (int n = 0; !options.host.empty(); ++n) {
        const int wanted = options.port + n;
        const bool any = options.port == 0 || n > kNextPorts || wanted > 65535;
        const int port = any ? server.bind_to_any_port(options.host)
                         : server.bind_to_port(options.host, wanted) ? wanted
                                                                     : -1;
        if (port > 0) return port;
        if (any || !options.next_port || errno != EADDRINUSE) break;
    }
    const std::string where = fmt::format("--set host={} --port {}", options.host, options.port);
    if (errno == EADDRINUSE)
        throw Error(
            fmt::format("{}: the port is in use; choose another (0: any free port)", where));
    if (errno == EACCES)
        throw Error(
            fmt::format("{}: no permission; choose a port from 1024 on (0: any free port)", where));
    throw Error(fmt::format("{}: expected an address of this machine, such as 127.0.0.1", where));
}

}  // namespace

void serve_files(const SiteFolder& folder, const ServerOptions& options) {
    std::string name = options.host;
    if (name.find(':') != name.npos) name = fmt::format("[{}]", name);
    const bool loopback = is_loopback(name);
    httplib::Server server;
    set_up(server, folder, options, loopback);
    const int port = bind(server, options);
    // All addresses: other machines know this one by its name.
    std::array<char, 256> own{};
    if ((name == "0.0.0.0" || name == "[::]") && ::gethostname(own.data(), own.size() - 1) == 0)
        name = own.data();
    end_at_signals();
    options.on_listening(fmt::format("http://{}:{}/{}", name, port, folder.start()), port,
                         loopback);
    std::future<bool> run =
        std::async(std::launch::async, [&server] { return server.listen_after_bind(); });
    while (run.wait_for(milliseconds(50)) == std::future_status::timeout &&
           !(ending && server.is_running())) {
    }
    if (!ending)
        throw Error(fmt::format("{}:{}: the system accepts no more connections", name, port));
    server.stop();
    // Connections may keep their threads for some seconds more.
    if (run.wait_for(milliseconds(500)) == std::future_status::timeout) std::_Exit(0);
}

}  // namespace vog::cli

#else

namespace vog::cli {

void serve_files(const SiteFolder&, const ServerOptions&) {
    throw Error(
        "serve: this build has no HTTP library (libcpp-httplib-dev); python3 -m http.server --bind "
        "127.0.0.1 --directory FOLDER shows a site, too");
}

}  // namespace vog::cli

#endif
