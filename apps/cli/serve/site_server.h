// site_server.h: files of a folder by HTTP, for one machine or a trusted network.
#pragma once

#include <functional>
#include <string>

#include "serve/site_folder.h"

namespace vog::cli {

struct ServerOptions {
    std::string host = "127.0.0.1";  ///< address or name to listen at
    int port = 8080;                 ///< 0: any free one
    bool next_port = false;          ///< a port in use is replaced by the next free one
    std::string allow_origin;        ///< origin whose pages may read the files, or *; empty: none

    /// The server accepts connections: its URL, port, and whether this machine alone reaches it.
    std::function<void(const std::string& url, int port, bool loopback)> on_listening;
    /// One line a request, from several threads; null: none.
    std::function<void(const std::string& line)> on_request;
};

/// Answers GET and HEAD requests until SIGINT, SIGTERM or SIGHUP, which end it well: connections get
/// half a second, then the process ends (docs/streaming.md).
/// throws  vog::Error where it cannot listen, and where the build has no HTTP library
void serve_files(const SiteFolder& folder, const ServerOptions& options);

}  // namespace vog::cli
