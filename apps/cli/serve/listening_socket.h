// listening_socket.h: the address and port that a server accepts connections at.
#pragma once

#include <string>

namespace vog::cli {

/// A socket that listens. The receiver of `descriptor` closes it.
struct ListeningSocket {
    int descriptor = -1;
    int port = 0;           ///< the one that was free
    bool loopback = false;  ///< reached from this machine alone
    std::string authority;  ///< host and port of its URLs: "127.0.0.1:8080"
};

/// host  an address or a name of this machine; 0.0.0.0 or ::, all of its addresses
/// port  0: any free one
/// next  whether a port in use is replaced by the next free one: of 20, then any
/// throws  vog::Error where the address or the port cannot be had
ListeningSocket listen_at(const std::string& host, int port, bool next);

}  // namespace vog::cli
