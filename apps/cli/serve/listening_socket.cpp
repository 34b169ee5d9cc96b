// listening_socket.cpp: resolving, binding, and the URL of what was bound.
#include "serve/listening_socket.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <memory>
#include <system_error>

#include "vog/error.h"

namespace vog::cli {

namespace {

constexpr int kNextPorts = 20;  // tried after the first
constexpr int kBacklog = 128;   // connections that wait for the server in the system

using Addresses = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

Addresses addresses_of(const std::string& host) {
    addrinfo hints{};
    hints.ai_socktype = SOCK_STREAM;
    hints.ai_flags = AI_PASSIVE;
    addrinfo* found = nullptr;
    const int failure =
        host.empty() ? EAI_NONAME : ::getaddrinfo(host.c_str(), "0", &hints, &found);
    if (failure != 0)
        throw Error(fmt::format("--host {}: {}, expected an address of this machine, as 127.0.0.1",
                                host, ::gai_strerror(failure)));
    return {found, &::freeaddrinfo};
}

/// Opens a socket that listens at an address; -1: errno has the reason.
int listening(const addrinfo& address, int port) {
    sockaddr_storage at{};
    std::copy_n(reinterpret_cast<const char*>(address.ai_addr), address.ai_addrlen,
                reinterpret_cast<char*>(&at));
    // The port has the same place in addresses of both families.
    reinterpret_cast<sockaddr_in*>(&at)->sin_port = htons(static_cast<std::uint16_t>(port));
    const int socket = ::socket(address.ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (socket < 0) return -1;
    // A port of a server that has just ended is free at once; one that listens is not shared.
    const int yes = 1;
    (void)::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    // Head and body of a response are two sends. Without this option, which connections inherit, the second
    // waits 40 ms for the client to confirm the first.
    (void)::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    if (::bind(socket, reinterpret_cast<sockaddr*>(&at), address.ai_addrlen) == 0 &&
        ::listen(socket, kBacklog) == 0)
        return socket;
    const int reason = errno;
    (void)::close(socket);
    errno = reason;
    return -1;
}

/// Describes what was bound.
ListeningSocket described(int descriptor, const std::string& host) {
    sockaddr_storage at{};
    socklen_t size = sizeof at;
    (void)::getsockname(descriptor, reinterpret_cast<sockaddr*>(&at), &size);
    ListeningSocket result;
    result.descriptor = descriptor;
    const auto& four = reinterpret_cast<const sockaddr_in&>(at);
    const auto& six = reinterpret_cast<const sockaddr_in6&>(at);
    const bool is_six = at.ss_family == AF_INET6;
    result.port = ntohs(is_six ? six.sin6_port : four.sin_port);
    result.loopback = is_six ? IN6_IS_ADDR_LOOPBACK(&six.sin6_addr) != 0
                             : ntohl(four.sin_addr.s_addr) >> 24 == 127;
    const bool any =
        is_six ? IN6_IS_ADDR_UNSPECIFIED(&six.sin6_addr) != 0 : four.sin_addr.s_addr == INADDR_ANY;
    std::string name = host.find(':') == host.npos ? host : fmt::format("[{}]", host);
    std::array<char, 256> own{};
    // All addresses: other machines know this one by its name.
    if (any && ::gethostname(own.data(), own.size() - 1) == 0) name = own.data();
    result.authority = fmt::format("{}:{}", name, result.port);
    return result;
}

}  // namespace

ListeningSocket listen_at(const std::string& host, int port, bool next) {
    const Addresses addresses = addresses_of(host);
    int reason = 0;
    for (int n = 0; n <= (next ? kNextPorts + 1 : 0); ++n) {
        const int tried = n > kNextPorts || port + n > 65535 ? 0 : port + n;
        for (const addrinfo* one = addresses.get(); one; one = one->ai_next) {
            const int socket = listening(*one, tried);
            if (socket >= 0) return described(socket, host);
            reason = errno;
        }
        if (reason != EADDRINUSE) break;
    }
    const std::string where = fmt::format("--host {} --port {}", host, port);
    if (reason == EADDRINUSE)
        throw Error(fmt::format("{}: the port is in use, expected a free one (0: any)", where));
    if (reason == EACCES)
        throw Error(fmt::format("{}: no permission, expected a port from 1024 on (0: any)", where));
    throw Error(fmt::format("{}: {}", where, std::generic_category().message(reason)));
}

}  // namespace vog::cli
