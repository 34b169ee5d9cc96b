// gpu_sums.h: Pictures that stay in GPU memory, as sums per pixel, and OpenGL buffers that receive them there: a window
// shows them without host memory between.
#pragma once

#include <memory>
#include <vector>

namespace vog {

/// Size of a picture of sums.
struct SumsSize {
    int width = 0, height = 0;
    int rays = 1;  ///< rays^2 rays a pixel, on a square lattice; sums are their means
};

/// Numbers of a field in sums: (value - reference) / unit.
struct SumsUnit {
    double reference = 0, unit = 1;
};

/// Sums per pixel in GPU memory, floats [height][width][channels], rows from the top. Complete when the call that drew them
/// returns. Kept from picture to picture: memory is allocated for larger ones alone.
///   1 channel   T at extinction 1
///   4 channels  T, T times a field's mean, T times its mean square, 0; of FieldPart::magnitude with a mean of 0; of a
///               maximum likewise with 1 in place of T, 0 where there is none; or premultiplied colours
class GpuSums {
  public:
    GpuSums();
    ~GpuSums();
    GpuSums(GpuSums&&) noexcept;
    GpuSums& operator=(GpuSums&&) noexcept;

    int width() const;
    int height() const;
    int channels() const;
    /// Copies them to host memory. throws vog::Error for an error of the GPU
    std::vector<float> fetch() const;

    struct State;
    State& state() const { return *state_; }

  private:
    std::unique_ptr<State> state_;
};

/// Buffer object of OpenGL that receives sums on the GPU. All calls need the context that was current at construction.
class GlSumsBuffer {
  public:
    /// Whether the GPU of the CUDA and OptiX renderers draws the current OpenGL context, too. False without a GPU, in builds
    /// without CUDA, for software, for another GPU and for a remote display.
    static bool possible();
    /// buffer  name of a buffer object with its memory; keeps both until this object's end
    /// throws  vog::Error unless possible(), and for an error of the GPU
    explicit GlSumsBuffer(unsigned buffer);
    ~GlSumsBuffer();
    GlSumsBuffer(GlSumsBuffer&&) noexcept;
    GlSumsBuffer& operator=(GlSumsBuffer&&) noexcept;

    /// Copies sums to the begin of the buffer. On return OpenGL may read the buffer and a renderer the sums' memory.
    /// throws  vog::Error for a buffer with less memory, for an error of the GPU
    void copy(const GpuSums& sums);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace vog
