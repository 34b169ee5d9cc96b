// site_server.cpp: responses, threads and signals of the server, on cpp-httplib.
#include "serve/site_server.h"

#include "vog/error.h"

#ifdef VOG_HTTPLIB

#include <fmt/format.h>
#include <httplib.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <mutex>
#include <thread>

#include "serve/connection.h"
#include "serve/listening_socket.h"
#include "serve/request_head.h"

namespace vog::cli {

namespace {

// Browsers open six connections to a server. A thread waits for the network or the disk nearly always.
constexpr std::size_t kThreads = 32;
constexpr int kLargestQueue =
    64;  // connections that wait for a thread; further ones wait in the system
constexpr int kRequestsPerClient = 1000;  // on one connection

/// Threads with a queue that ends.
class BoundedThreads : public httplib::ThreadPool {
  public:
    explicit BoundedThreads(ServerState& state) : httplib::ThreadPool(kThreads), state_(state) {}

    /// Waits while the queue is full.
    void enqueue(std::function<void()> serve) override {
        while (state_.waiting >= kLargestQueue && !state_.ending)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        ++state_.waiting;
        httplib::ThreadPool::enqueue([this, serve = std::move(serve)] {
            --state_.waiting;
            serve();
        });
    }

  private:
    ServerState& state_;
};

/// A checked head, then the connection: what the library reads and writes. It is given the fields that
/// the answers need and no others: it would read bodies and heads of any size.
class CheckedStream : public httplib::Stream {
  public:
    CheckedStream(Connection& connection, const RequestHead& head) : connection_(connection) {
        text_ = fmt::format("{} {} HTTP/1.1\r\n", head.method, head.path);
        for (const char* name : {"range", "if-none-match", "if-range"})
            if (const auto field = head.fields.find(name); field != head.fields.end())
                // Other ranges are answered by the whole file; the library would refuse them.
                if (field->first != "range" ||
                    requested_range(field->second, UINT64_MAX).kind != RangeRequest::Kind::whole)
                    text_ += fmt::format("{}: {}\r\n", name, field->second);
        text_ += "\r\n";
    }

    bool is_readable() const override { return read_ < text_.size(); }
    bool is_writable() const override { return true; }
    ssize_t read(char* to, std::size_t size) override {
        size = text_.copy(to, size, read_);
        read_ += size;
        return static_cast<ssize_t>(size);
    }
    ssize_t write(const char* from, std::size_t size) override {
        return connection_.send({from, size}) ? static_cast<ssize_t>(size) : -1;
    }
    // The answers depend on no address.
    void get_remote_ip_and_port(std::string& address, int& port) const override {
        address.clear(), port = 0;
    }
    void get_local_ip_and_port(std::string& address, int& port) const override {
        address.clear(), port = 0;
    }
    socket_t socket() const override { return connection_.descriptor(); }

  private:
    Connection& connection_;
    std::string text_;
    std::size_t read_ = 0;
};

/// Sends a part of a file in pieces.
httplib::ContentProvider provider_of(const SiteFile& file, std::uint64_t first) {
    return [file, first](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
        std::array<char, 1 << 16> buffer;
        const ssize_t count =
            ::pread(file.file->descriptor(), buffer.data(), std::min(length, buffer.size()),
                    static_cast<off_t>(first + offset));
        // A file that has become shorter: the response stays incomplete, which its length shows.
        return count > 0 && sink.write(buffer.data(), static_cast<std::size_t>(count));
    };
}

class SiteServer : public httplib::Server {
  public:
    SiteServer(const SiteFolder& folder, const ServerOptions& options,
               const ListeningSocket& socket)
        : folder_(folder), options_(options), socket_(socket) {
        svr_sock_ = socket.descriptor;
        new_task_queue = [this] { return new BoundedThreads(state_); };
        set_keep_alive_timeout(limits_.idle.count() / 1000);
        set_keep_alive_max_count(kRequestsPerClient);
        set_pre_routing_handler(
            [this](const httplib::Request& request, httplib::Response& response) {
                answer(request, response);
                return HandlerResponse::Handled;
            });
        set_logger([this](const httplib::Request& request, const httplib::Response& response) {
            log(request.method, request.target, response.status);
        });
    }

    /// Ends run(). From another thread.
    void end() {
        state_.ending = true;
        while (!is_running() && !ended_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        stop();
    }

    /// Accepts connections until end().
    /// returns  whether no failure ended it
    bool run() {
        const bool well = listen_after_bind();
        ended_ = true;
        return well || state_.ending;
    }

  private:
    bool process_and_close_socket(socket_t socket) override {
        Connection connection(socket, state_, limits_);
        try {
            int left = kRequestsPerClient;
            while (answer_next(connection, --left == 0)) {
            }
            connection.finish();
        } catch (const std::exception& error) {
            // As where memory is short: this client loses its connection, others are served.
            log("closed", error.what(), 500);
        }
        return true;
    }

    /// returns  whether another request may follow
    bool answer_next(Connection& connection, bool last) {
        std::string text;
        const Connection::Arrival arrival = connection.receive_head(text);
        if (arrival == Connection::Arrival::closed) return false;
        connection.begin_response();
        RequestHead head;
        if (arrival == Connection::Arrival::late)
            head.status = 408, head.reason = "the request did not arrive in time";
        else if (arrival == Connection::Arrival::large)
            head.status = 431, head.reason = "the request's head is too large";
        else
            head = parse_request_head(text, !options_.allow_origin.empty());
        if (head.status == 200 && socket_.loopback &&
            !is_loopback_host(head.fields["host"], options_.host))
            head.status = 403, head.reason = "expected a Host of this machine, as localhost";
        if (head.status != 200) {
            refuse(connection, head);
            return false;
        }
        CheckedStream stream(connection, head);
        const bool close = last || !head.keeps_open;
        bool closed = false;
        // Ranges are of send_file(): the library gives those beyond the file a wrong length.
        const auto setup = [](httplib::Request& request) { request.ranges.clear(); };
        return process_request(stream, close, closed, setup) && !close;
    }

    /// Sends a refusal, after which the connection is closed.
    void refuse(Connection& connection, const RequestHead& head) {
        static const std::map<int, const char*> names = {{400, "Bad Request"},
                                                         {403, "Forbidden"},
                                                         {405, "Method Not Allowed"},
                                                         {408, "Request Timeout"},
                                                         {413, "Content Too Large"},
                                                         {414, "URI Too Long"},
                                                         {431, "Request Header Fields Too Large"},
                                                         {505, "HTTP Version Not Supported"}};
        (void)connection.send(fmt::format(
            "HTTP/1.1 {} {}\r\n{}Content-Type: text/plain; charset=utf-8\r\n"
            "X-Content-Type-Options: nosniff\r\nConnection: close\r\nContent-Length: {}\r\n\r\n{}",
            head.status, names.at(head.status), head.status == 405 ? "Allow: GET, HEAD\r\n" : "",
            head.reason.size() + 1, head.method == "HEAD" ? "" : head.reason + "\n"));
        log("refused", head.reason, head.status);
    }

    void answer(const httplib::Request& request, httplib::Response& response) const {
        const bool open = !options_.allow_origin.empty();
        response.set_header("X-Content-Type-Options", "nosniff");
        response.set_header("Cross-Origin-Resource-Policy", open ? "cross-origin" : "same-origin");
        if (open) {
            response.set_header("Access-Control-Allow-Origin", options_.allow_origin);
            response.set_header("Access-Control-Expose-Headers", "Content-Range, ETag");
        }
        if (request.method == "OPTIONS") {
            response.status = 200;
            response.set_header("Access-Control-Allow-Methods", "GET, HEAD");
            response.set_header("Access-Control-Allow-Headers", "Range, If-None-Match, If-Range");
            // Asked by Chromium for pages of the internet that read from this machine.
            response.set_header("Access-Control-Allow-Private-Network", "true");
            return;
        }
        const std::optional<SiteFile> file = folder_.open(request.target);
        if (!file) {
            response.status = 404;
            response.set_header("Cache-Control", "no-cache");
            response.set_content("no such file\n", "text/plain; charset=utf-8");
            return;
        }
        response.set_header("Cache-Control",
                            file->immutable ? "public, max-age=31536000, immutable" : "no-cache");
        response.set_header("ETag", file->tag);
        response.set_header("Accept-Ranges", "bytes");
        if (request.get_header_value("If-None-Match").find(file->tag) != std::string::npos) {
            response.status = 304;
            response.set_header("Content-Length", std::to_string(file->size));
            return;
        }
        send_file(*file, request, response);
    }

    /// The whole file, or the part that is asked for.
    static void send_file(const SiteFile& file, const httplib::Request& request,
                          httplib::Response& response) {
        RangeRequest range;
        // A range of other content than the client has begun with is answered by the whole.
        if (!request.has_header("If-Range") || request.get_header_value("If-Range") == file.tag)
            range = requested_range(request.get_header_value("Range"), file.size);
        if (range.kind == RangeRequest::Kind::beyond) {
            response.status = 416;
            response.set_header("Content-Range", fmt::format("bytes */{}", file.size));
            return;
        }
        const bool part = range.kind == RangeRequest::Kind::part;
        if (!part) range.count = file.size;
        response.status = part ? 206 : 200;
        if (part)
            response.set_header("Content-Range",
                                fmt::format("bytes {}-{}/{}", range.first,
                                            range.first + range.count - 1, file.size));
        if (range.count == 0)
            response.set_header("Content-Type", file.type);
        else
            response.set_content_provider(range.count, file.type, provider_of(file, range.first));
    }

    void log(const std::string& method, const std::string& text, int status) const {
        if (!options_.on_request) return;
        const std::lock_guard lock(log_mutex_);
        options_.on_request(fmt::format("{} {} {}", status, method, text));
    }

    const SiteFolder& folder_;
    const ServerOptions& options_;
    const ListeningSocket& socket_;
    const TimeLimits limits_;
    ServerState state_;
    std::atomic<bool> ended_ = false;
    mutable std::mutex log_mutex_;
};

/// Signals that end a server, held back from every thread until sigwait() takes one. Those that the
/// parent has made us ignore, such as nohup's, stay ignored.
class HeldSignals {
  public:
    HeldSignals() {
        ::sigemptyset(&set_);
        ::sigaddset(&set_, SIGTERM);
        for (const int number : {SIGINT, SIGHUP}) {
            struct sigaction action {};
            if (::sigaction(number, nullptr, &action) == 0 && action.sa_handler != SIG_IGN)
                ::sigaddset(&set_, number);
        }
        ::pthread_sigmask(SIG_BLOCK, &set_, &before_);
    }
    ~HeldSignals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
    void wait() const {
        int number = 0;
        (void)::sigwait(&set_, &number);
    }

  private:
    sigset_t set_{}, before_{};
};

/// Ends a server at the first signal.
class SignalThread {
  public:
    SignalThread(const HeldSignals& signals, SiteServer& server)
        : thread_([&] {
              signals.wait();
              server.end();
          }) {}
    /// Signals the thread itself, where the server has ended otherwise.
    ~SignalThread() {
        (void)::pthread_kill(thread_.native_handle(), SIGTERM);
        thread_.join();
    }
    SignalThread(const SignalThread&) = delete;
    SignalThread& operator=(const SignalThread&) = delete;

  private:
    std::thread thread_;
};

}  // namespace

void serve_files(const SiteFolder& folder, const ServerOptions& options) {
    const HeldSignals signals;
    if (options.prepare) options.prepare();
    const ListeningSocket socket = listen_at(options.host, options.port, options.next_port);
    SiteServer server(folder, options, socket);
    if (options.on_listening)
        options.on_listening(fmt::format("http://{}/{}", socket.authority, folder.start()),
                             socket.port, socket.loopback);
    const SignalThread ending(signals, server);
    if (!server.run())
        throw Error(fmt::format("{}: the system accepts no more connections", socket.authority));
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
