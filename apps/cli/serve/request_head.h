// request_head.h: request line and fields of an HTTP request, checked before anything acts on them.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace vog::cli {

/// Largest request line and head, bytes, and largest number of fields. Browsers send 0.5 to 2 kB in
/// some 20 fields; paths of a site have 50 bytes.
constexpr std::size_t kLargestRequestLine = 8192, kLargestRequestHead = 16384, kMostFields = 64;

/// Head of a request, or why it is refused.
struct RequestHead {
    int status = 200;    ///< HTTP status of the refusal; 200: none
    std::string reason;  ///< of the refusal, one line
    std::string method;  ///< GET, HEAD or OPTIONS
    std::string path;    ///< as sent, percent-encoded, without its query
    std::map<std::string, std::string>
        fields;              ///< by lower-case name; repeated ones joined by ", "
    bool keeps_open = true;  ///< whether the client may send another request
};

/// Number of bytes of the head at the beginning of received bytes, its empty line included; 0: not
/// yet whole.
std::size_t head_size(std::string_view received);

/// Parses a head (RFC 9112), strictly: lines that end in anything but CR LF, folded fields, control
/// characters, a target that is no path, requests with a body and methods that change something are
/// refused.
/// preflight  whether OPTIONS is a method: pages of another origin send it before some requests
RequestHead parse_request_head(std::string_view text, bool preflight);

/// Whether a Host field names this machine's loopback: localhost, 127.0.0.1, [::1] or `own`, with any
/// port, as tunnels have others. Pages of another name are thus refused even if their name server
/// gives it this address (DNS rebinding).
bool is_loopback_host(std::string_view field, std::string_view own);

/// Bytes that a Range field asks for (RFC 9110, 14.2).
struct RangeRequest {
    enum class Kind { whole, part, beyond };
    Kind kind = Kind::whole;  ///< whole also for several ranges and units other than bytes
    std::uint64_t first = 0, count = 0;  ///< of a part; count > 0
};
RangeRequest requested_range(std::string_view field, std::uint64_t size);

}  // namespace vog::cli
