// serve.cpp: vog serve: a site, a page or a compact model by HTTP on this machine.
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <regex>
#include <string>

#include "commands/commands.h"
#include "files/film.h"
#include "options/parser/settings.h"
#include "options/parser/validators.h"
#include "serve/site_folder.h"
#include "serve/site_server.h"
#include "terminal/terminal.h"
#include "vog/error.h"
#include "vog/export_html.h"
#include "vog/temporary_file.h"
#include "vog/vogz.h"

namespace vog::cli {

namespace {

struct ServeArguments {
    std::string input;
    ServerOptions server;
    bool open = false, verbose = false;
};

/// An origin is a scheme, a host and perhaps a port, as browsers send it: https://example.org:8443
CLI::Validator origin() {
    const auto check = [](const std::string& text) {
        static const std::regex origins(R"(\*|https?://[!-+.0-~-]+)");  // no space, comma or slash
        return std::regex_match(text, origins)
                   ? std::string{}
                   : fmt::format("{}: expected an origin such as https://example.org, or *", text);
    };
    return {check, "ORIGIN"};
}

/// Opens an address in the desktop's browser, without waiting for it.
/// url  of a bound address and an encoded path: it has no quotes
void open_browser(const std::string& url) {
    if (program_path("xdg-open").empty())
        return note("--open: the program xdg-open is not installed; open the address in a browser");
    if (std::system(fmt::format("xdg-open '{}' </dev/null >/dev/null 2>&1 &", url).c_str()) != 0)
        note("--open: xdg-open failed; open the address in a browser");
}

/// Has a compact file that pages can stream shown by one. The page is a file without a name.
void begin_with_page(SiteFolder& folder, const std::filesystem::path& file) {
    const std::string why = read_vogz_info(file).not_streamed;
    if (!why.empty()) return note(fmt::format("{}: served without a page: {}", file.string(), why));
    const std::vector<HtmlModel> models = models_to_stream(file);
    HtmlOptions options;
    options.title = models.front().name;
    const TemporaryFile page(std::filesystem::temp_directory_path() / "page.html");
    write_streaming_page(page.path(), models, {folder.only(), true}, options);
    folder.begin_with(open_shared(page.path()));
}

void serve(ServeArguments arguments, bool port_given) {
    SiteFolder folder(arguments.input);
    ServerOptions& server = arguments.server;
    if (folder.only().ends_with(".vogz")) begin_with_page(folder, arguments.input);
    server.next_port = !port_given;
    server.on_listening = [&](const std::string& url, int port, bool loopback) {
        if (!port_given && port != server.port)
            note(fmt::format("port {} is in use; using port {}", server.port, port));
        if (!loopback)
            note(fmt::format("--set host={}: every machine that reaches this one can read {}",
                             server.host, arguments.input));
        print_line(url);
        finish_output();
        if (arguments.open) open_browser(url);
    };
    if (arguments.verbose) server.on_request = [](const std::string& line) { note(line); };
    serve_files(folder, server);
}

}  // namespace

void add_serve(CLI::App& app) {
    auto arguments = std::make_shared<ServeArguments>();
    CLI::App* command = app.add_subcommand(
        "serve",
        "Serve a site, a page or a compact model to browsers on this machine, until Ctrl-C");
    command
        ->add_option("site", arguments->input,
                     "Site folder from vog page MODEL -o site/, one page (.html) or one compact "
                     "model (.vogz; a page shows it if it was written with --hierarchy --deflate). "
                     "Nothing else is served")
        ->required();
    CLI::Option* port =
        add_value(*command, "--port", arguments->server.port, "[0, 65535]",
                  "Port to listen on; 0: any free port. Default: 8080, or the next free port");
    add_value(*command, setting("host"), arguments->server.host, "",
              "Address or name to listen on. Other machines can read the site unless it is this "
              "machine's loopback; 0.0.0.0: all addresses");
    command
        ->add_option(setting("allow-origin"), arguments->server.allow_origin,
                     "Origin whose pages may read the files, such as https://example.org, or * for "
                     "all. Default: only the site's own page")
        ->check(origin());
    command->add_flag("--open", arguments->open,
                      "Open the address in the desktop's browser (xdg-open)");
    command->add_flag("--verbose,-v", arguments->verbose, "Print each request to standard error");
    command->callback([arguments, port] { serve(*arguments, port->count() > 0); });
}

}  // namespace vog::cli
