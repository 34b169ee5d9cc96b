// command_server.cpp: the command many times from one process: loading its libraries takes longer than most runs of tests.
// Each line of standard input is a run, its words divided by NUL: folder, files for standard output and error, seconds
// at most, arguments. Each run is a fork; its wait status is the line of the answer (command_server.py).
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

int vog_main(int argc, char** argv);  // main() of apps/cli/main.cpp

namespace {

void redirect(const std::string& file, int to, int flags) {
    const int from = ::open(file.c_str(), flags, 0644);
    if (from < 0 || ::dup2(from, to) < 0) std::_Exit(125);
    ::close(from);
}

[[noreturn]] void run(std::vector<std::string> words) {
    ::alarm(static_cast<unsigned>(std::stoul(words[3])));
    if (::chdir(words[0].c_str()) != 0) std::_Exit(125);
    redirect("/dev/null", STDIN_FILENO, O_RDONLY);
    redirect(words[1], STDOUT_FILENO, O_WRONLY | O_CREAT | O_TRUNC);
    redirect(words[2], STDERR_FILENO, O_WRONLY | O_CREAT | O_TRUNC);
    words.erase(words.begin(), words.begin() + 3);
    words.front() = "vog";
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const int status = vog_main(static_cast<int>(words.size()), arguments.data());
    std::cout.flush();
    std::fflush(nullptr);
    std::_Exit(status);  // without destructors that wait for threads, which a fork does not have
}

}  // namespace

int main() {
    for (std::string line; std::getline(std::cin, line);) {
        std::vector<std::string> words{""};
        for (const char letter : line)
            if (letter == '\0')
                words.emplace_back();
            else
                words.back() += letter;
        const pid_t child = ::fork();
        if (child == 0) run(std::move(words));
        int status = 0;
        if (child < 0 || ::waitpid(child, &status, 0) != child) return 1;
        std::cout << status << std::endl;
    }
}
