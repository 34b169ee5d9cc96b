// graphics_test.cpp: The emulated GPU's buffers of OpenGL: contents both ways, and refusals of misuse.
#include <cuda_gl_interop.h>

#include <cstring>
#include <stdexcept>
#include <thread>
#include <utility>

#include "emulation/emulation.h"
#include "gl/gl_objects.h"
#include "viewer/headless.h"

namespace vog::test {

namespace {

using viewer::GlBuffer;

GlBuffer buffer_of(const std::vector<float>& values) {
    GlBuffer buffer = viewer::make_buffer();
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer);
    glBufferData(GL_PIXEL_UNPACK_BUFFER, static_cast<GLsizeiptr>(values.size() * sizeof(float)),
                 values.data(), GL_STREAM_DRAW);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    return buffer;
}
std::vector<float> contents(const GlBuffer& buffer, std::size_t count) {
    std::vector<float> values(count);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer);
    glGetBufferSubData(GL_PIXEL_UNPACK_BUFFER, 0, static_cast<GLsizeiptr>(count * sizeof(float)),
                       values.data());
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    return values;
}
std::vector<float> mapped_contents(cudaGraphicsResource_t resource) {
    void* data = nullptr;
    std::size_t bytes = 0;
    EXPECT_EQ(cudaGraphicsResourceGetMappedPointer(&data, &bytes, resource), cudaSuccess);
    std::vector<float> values(bytes / sizeof(float));
    (void)cudaMemcpy(values.data(), data, bytes, cudaMemcpyDeviceToHost);
    return values;
}
void write(cudaGraphicsResource_t resource, const std::vector<float>& values) {
    void* data = nullptr;
    std::size_t bytes = 0;
    EXPECT_EQ(cudaGraphicsResourceGetMappedPointer(&data, &bytes, resource), cudaSuccess);
    (void)cudaMemcpy(data, values.data(), values.size() * sizeof(float), cudaMemcpyHostToDevice);
}

constexpr unsigned kNone = cudaGraphicsRegisterFlagsNone;
constexpr unsigned kReadOnly = cudaGraphicsRegisterFlagsReadOnly;
constexpr unsigned kDiscard = cudaGraphicsRegisterFlagsWriteDiscard;

}  // namespace

class emulated_graphics : public headless {
  protected:
    cudaGraphicsResource_t resource_ = nullptr;
};

TEST_F(emulated_graphics, buffers_have_what_cuda_writes_once_they_are_unmapped) {
    const GlBuffer buffer = buffer_of({1, 2, 3});
    ASSERT_EQ(cudaGraphicsGLRegisterBuffer(&resource_, buffer, kNone), cudaSuccess);
    ASSERT_EQ(cudaGraphicsMapResources(1, &resource_), cudaSuccess);
    EXPECT_EQ(mapped_contents(resource_), (std::vector<float>{1, 2, 3}));
    write(resource_, {4, 5});
    // OpenGL has no use of the buffer now.
    viewer::GlTarget target(GL_R32F, 3, 1);
    target.clear();
    target.upload_from(buffer);
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_INVALID_OPERATION));
    EXPECT_EQ(target.read_floats(), (std::vector<float>{0, 0, 0}));
    ASSERT_EQ(cudaGraphicsUnmapResources(1, &resource_), cudaSuccess);
    EXPECT_EQ(contents(buffer, 3), (std::vector<float>{4, 5, 3}));
    target.upload_from(buffer);
    EXPECT_EQ(target.read_floats(), (std::vector<float>{4, 5, 3}));
    EXPECT_EQ(cudaGraphicsUnregisterResource(resource_), cudaSuccess);
}

TEST_F(emulated_graphics, discarded_contents_are_not_there) {
    const GlBuffer buffer = buffer_of({1, 2, 3});
    ASSERT_EQ(cudaGraphicsGLRegisterBuffer(&resource_, buffer, kDiscard), cudaSuccess);
    ASSERT_EQ(cudaGraphicsMapResources(1, &resource_), cudaSuccess);
    write(resource_, {4, 5});
    ASSERT_EQ(cudaGraphicsUnmapResources(1, &resource_), cudaSuccess);
    EXPECT_TRUE(std::isnan(contents(buffer, 3)[2]));
    EXPECT_EQ(cudaGraphicsUnregisterResource(resource_), cudaSuccess);
}

TEST_F(emulated_graphics, what_is_no_buffer_is_not_registered) {
    EXPECT_EQ(cudaGraphicsGLRegisterBuffer(&resource_, 12345, kDiscard), cudaErrorInvalidValue);
    const GlBuffer empty = viewer::make_buffer();
    EXPECT_EQ(cudaGraphicsGLRegisterBuffer(&resource_, empty, kDiscard), cudaErrorInvalidValue);
    (void)cudaGetLastError();
}

TEST_F(emulated_graphics, misuse_is_refused) {
    const auto refusal = [](const auto& use) -> std::string {
        emulation::set_refusals_throw(true);
        std::string what = "none";
        try {
            use();
        } catch (const std::runtime_error& error) {
            what = error.what();
        }
        emulation::set_refusals_throw(false);
        return what;
    };
    const auto is = [&](const std::string& words, const auto& use) {
        EXPECT_NE(refusal(use).find(words), std::string::npos) << words;
    };
    GlBuffer buffer = buffer_of({1, 2, 3}), deleted = buffer_of({1}), resized = buffer_of({1});
    is("flags", [&] { (void)cudaGraphicsGLRegisterBuffer(&resource_, buffer, 8); });
    cudaGraphicsResource_t of_deleted = nullptr, of_resized = nullptr, again = nullptr;
    ASSERT_EQ(cudaGraphicsGLRegisterBuffer(&resource_, buffer, kReadOnly), cudaSuccess);
    ASSERT_EQ(cudaGraphicsGLRegisterBuffer(&of_deleted, deleted, kDiscard), cudaSuccess);
    ASSERT_EQ(cudaGraphicsGLRegisterBuffer(&of_resized, resized, kDiscard), cudaSuccess);
    is("twice", [&] { (void)cudaGraphicsGLRegisterBuffer(&again, buffer, kReadOnly); });
    is("not mapped", [&] { (void)mapped_contents(resource_); });
    is("not mapped", [&] { (void)cudaGraphicsUnmapResources(1, &resource_); });
    const GLuint name = deleted;
    deleted = GlBuffer();
    EXPECT_FALSE(glIsBuffer(name));
    is("deleted", [&] { (void)cudaGraphicsUnregisterResource(of_deleted); });
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, resized);
    glBufferData(GL_PIXEL_UNPACK_BUFFER, 8, nullptr, GL_STREAM_DRAW);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    is("other memory", [&] { (void)cudaGraphicsMapResources(1, &of_resized); });
    std::thread([&] {
        is("without its context", [&] { (void)cudaGraphicsMapResources(1, &resource_); });
    }).join();
    ASSERT_EQ(cudaGraphicsMapResources(1, &resource_), cudaSuccess);
    is("mapped twice", [&] { (void)cudaGraphicsMapResources(1, &resource_); });
    is("mapped buffer", [&] { (void)cudaGraphicsUnregisterResource(resource_); });
    write(resource_, {7});
    is("for reading is written", [&] { (void)cudaGraphicsUnmapResources(1, &resource_); });
    write(resource_, {1});
    ASSERT_EQ(cudaGraphicsUnmapResources(1, &resource_), cudaSuccess);
    EXPECT_EXIT(std::exit(0), testing::ExitedWithCode(EXIT_FAILURE), "never unregistered");
    ASSERT_EQ(cudaGraphicsUnregisterResource(resource_), cudaSuccess);
    ASSERT_EQ(cudaGraphicsUnregisterResource(of_resized), cudaSuccess);
    is("not registered", [&] { (void)cudaGraphicsMapResources(1, &resource_); });
}

}  // namespace vog::test
