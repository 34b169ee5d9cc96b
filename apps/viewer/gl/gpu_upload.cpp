// gpu_upload.cpp: One buffer object for the pictures of all GPU renderers, as large as the largest.
#include "gl/gpu_upload.h"

#include "render/gpu/sums/gpu_sums.h"
#include "vog/error.h"

namespace vog::viewer {

bool GpuUpload::stays_on_gpu() {
    if (!stays_on_gpu_) stays_on_gpu_ = GlSumsBuffer::possible();
    return *stays_on_gpu_;
}

void GpuUpload::require_buffer(std::size_t bytes) {
    if (shared_ && bytes <= bytes_) return;
    shared_.reset();
    buffer_ = make_buffer();
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer_);
    glBufferData(GL_PIXEL_UNPACK_BUFFER, static_cast<GLsizeiptr>(bytes), nullptr, GL_STREAM_DRAW);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    bytes_ = bytes;
    shared_.emplace(buffer_);
}

std::string GpuUpload::fill(const GlTarget& target, const GpuSums& sums) {
    std::string failure;
    if (stays_on_gpu()) {
        try {
            require_buffer(static_cast<std::size_t>(sums.width()) *
                           static_cast<std::size_t>(sums.height()) *
                           static_cast<std::size_t>(sums.channels()) * sizeof(float));
            shared_->copy(sums);
            target.upload_from(buffer_);
            return {};
        } catch (const Error& error) {
            failure = error.what();
            stays_on_gpu_ = false;
            shared_.reset();
        }
    }
    target.upload(sums.fetch());
    return failure;
}

}  // namespace vog::viewer
