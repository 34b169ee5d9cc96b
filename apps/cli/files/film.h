// film.h: films of pictures, encoded by ffmpeg as they are drawn.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>

#include "vog/image.h"
#include "vog/temporary_file.h"

namespace vog::cli {

/// Whether an output is a film: .mp4 or .webm.
bool is_film(const std::string& output);

/// Path of a program in the folders of PATH; empty: there is none.
std::string program_path(const std::string& name);

/// A film that is being written, beside its file, which it replaces when whole.
class Film {
  public:
    /// file        .mp4 (H.264) or .webm (VP9)
    /// per_second  pictures a second, > 0
    /// throws      vog::Error where no ffmpeg is installed
    Film(const std::string& file, double per_second);
    /// Ends ffmpeg. Without finish() no file is left.
    ~Film();
    Film(const Film&) = delete;
    Film& operator=(const Film&) = delete;

    /// Appends an opaque picture, all of one size.
    /// throws  vog::Error for a transparent one, and with ffmpeg's message where that ended
    void add(const Image& picture);
    /// Waits for ffmpeg, then gives the film its name.
    /// throws  vog::Error with ffmpeg's message
    void finish();
    int pictures() const { return pictures_; }

  private:
    void start(int width, int height);
    void close_input();
    [[noreturn]] void fail();

    std::string file_, program_;
    double per_second_;
    int pictures_ = 0;
    std::optional<TemporaryFile> beside_;
    pid_t process_ = -1;
    int input_ = -1;     ///< socket to its standard input
    int messages_ = -1;  ///< nameless file with its standard error
};

}  // namespace vog::cli
