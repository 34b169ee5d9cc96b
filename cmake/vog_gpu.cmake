# vog_add_gpu(TARGET): adds the GPU renderers that VOG_CUDA and VOG_OPTIX ask for to TARGET, whose
# sources include this project's src/ and include/. Used by the library and by the small build for
# machines with nothing but CUDA (tests/gpu).
#
# The CUDA runtime is linked statically and loads the driver when it is first called; OptiX is
# headers alone and loads its library likewise. The result starts on machines without a GPU.
set(VOG_GPU_ROOT ${CMAKE_CURRENT_LIST_DIR}/..)

# nvcc, CUDA's runtime and OptiX's headers, before the language is enabled.
macro(vog_find_gpu)
    if(NOT CMAKE_CUDA_COMPILER AND DEFINED ENV{CUDACXX})
        set(CMAKE_CUDA_COMPILER $ENV{CUDACXX})
    elseif(NOT CMAKE_CUDA_COMPILER)
        find_program(VOG_NVCC nvcc HINTS $ENV{CUDA_HOME}/bin $ENV{CUDA_PATH}/bin /usr/local/cuda/bin REQUIRED)
        set(CMAKE_CUDA_COMPILER ${VOG_NVCC})
    endif()
    if(NOT CMAKE_CUDA_ARCHITECTURES)
        # Code for Turing, Ampere, Ada, Hopper and Blackwell, as far as the compiler knows them, and PTX of the
        # first and the last for all others.
        execute_process(COMMAND ${CMAKE_CUDA_COMPILER} --list-gpu-code OUTPUT_VARIABLE known RESULT_VARIABLE failed)
        if(failed)
            message(FATAL_ERROR "${CMAKE_CUDA_COMPILER} --list-gpu-code: ${failed}, expected nvcc of CUDA 12 or newer")
        endif()
        set(CMAKE_CUDA_ARCHITECTURES 75)
        foreach(architecture 86 89 90)
            if(known MATCHES "sm_${architecture}")
                list(APPEND CMAKE_CUDA_ARCHITECTURES ${architecture}-real)
            endif()
        endforeach()
        if(known MATCHES "sm_120")
            list(APPEND CMAKE_CUDA_ARCHITECTURES 120)
        endif()
    endif()
    set(CMAKE_CUDA_STANDARD 17)  # CMake 3.25 knows no later one
    enable_language(CUDA)
    if(CMAKE_CUDA_COMPILER_VERSION VERSION_LESS 12)
        message(FATAL_ERROR "CUDA ${CMAKE_CUDA_COMPILER_VERSION}, expected 12 or newer")
    endif()
    find_package(CUDAToolkit REQUIRED)
    if(VOG_OPTIX)
        find_path(VOG_OPTIX_INCLUDE optix.h HINTS ${OptiX_ROOT}/include $ENV{OptiX_ROOT}/include)
        if(NOT VOG_OPTIX_INCLUDE)
            message(FATAL_ERROR "VOG_OPTIX needs OptiX's headers: set OptiX_ROOT to NVIDIA's SDK or to a clone "
                                "of its optix-dev repository, 8.0 or newer")
        endif()
        file(STRINGS ${VOG_OPTIX_INCLUDE}/optix.h version REGEX "#define OPTIX_VERSION ")
        string(REGEX MATCH "[0-9]+" version "${version}")
        if(version LESS 80000)
            message(FATAL_ERROR "OptiX ${version} in ${VOG_OPTIX_INCLUDE}, expected 80000 (8.0.0) or newer")
        endif()
    endif()
endmacro()

function(vog_add_gpu target)
    set(gpu ${VOG_GPU_ROOT}/src/render/gpu)
    set(own_include ${VOG_GPU_ROOT}/src ${VOG_GPU_ROOT}/include)
    set(cuda_options -Xcompiler=-Wall,-Wextra)
    if(VOG_WERROR)
        list(APPEND cuda_options -Werror=all-warnings -Xcompiler=-Werror)
    endif()

    # The kernels, for real devices.
    add_library(${target}_cuda OBJECT ${gpu}/cuda_splat.cu ${gpu}/chords/chord_kernels.cu
                ${gpu}/sums/sums_kernels.cu)
    set_target_properties(${target}_cuda PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_include_directories(${target}_cuda PRIVATE ${own_include})
    target_compile_options(${target}_cuda PRIVATE ${cuda_options})
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:${target}_cuda> ${gpu}/cuda_memory.cpp
                   ${gpu}/cuda_passes.cpp ${gpu}/cuda_renderer.cpp ${gpu}/chords/gpu_pictures.cpp
                   ${gpu}/chords/gpu_picture_sums.cpp ${gpu}/sums/gpu_sums.cpp)
    target_compile_definitions(${target} PRIVATE VOG_CUDA)
    # CUDA's header of OpenGL buffers includes OpenGL's; nothing of OpenGL is linked.
    find_path(VOG_GL_INCLUDE GL/gl.h)
    if(VOG_GL_INCLUDE)
        target_sources(${target} PRIVATE ${gpu}/sums/gl_sums.cpp)
        target_compile_definitions(${target} PRIVATE VOG_CUDA_GL)
    else()
        message(STATUS "No GL/gl.h: the window copies pictures of GPU renderers through host memory")
    endif()
    target_link_libraries(${target} PRIVATE CUDA::cudart_static)
    target_include_directories(${target} SYSTEM PRIVATE ${CUDAToolkit_INCLUDE_DIRS})
    if(NOT VOG_OPTIX)
        return()
    endif()

    # OptiX's programs to PTX: the driver compiles it for its device. The text is part of the library.
    add_library(${target}_optix OBJECT ${gpu}/optix/optix_programs.cu)
    set_target_properties(${target}_optix PROPERTIES CUDA_PTX_COMPILATION ON CUDA_ARCHITECTURES 75-virtual)
    target_include_directories(${target}_optix PRIVATE ${own_include})
    target_include_directories(${target}_optix SYSTEM PRIVATE ${VOG_OPTIX_INCLUDE} ${VOG_NANOVDB_INCLUDE})
    target_compile_options(${target}_optix PRIVATE ${cuda_options})
    set(embedded ${CMAKE_CURRENT_BINARY_DIR}/optix_programs_ptx.cpp)
    add_custom_command(OUTPUT ${embedded}
        COMMAND ${CMAKE_COMMAND} -DIN=$<TARGET_OBJECTS:${target}_optix> -DOUT=${embedded}
                -P ${VOG_GPU_ROOT}/cmake/embed_ptx.cmake
        DEPENDS ${target}_optix $<TARGET_OBJECTS:${target}_optix> ${VOG_GPU_ROOT}/cmake/embed_ptx.cmake VERBATIM)
    target_sources(${target} PRIVATE ${embedded} ${gpu}/optix/optix_device.cpp ${gpu}/optix/optix_pipeline.cpp ${gpu}/optix/optix_hierarchy.cpp
                   ${gpu}/optix/optix_film.cpp ${gpu}/optix/optix_model.cpp ${gpu}/optix/optix_volume.cpp
                   ${gpu}/optix/optix_chords.cpp ${gpu}/voxels/voxel_scene.cpp
                   ${gpu}/voxels/gpu_volumes.cpp)
    target_compile_definitions(${target} PRIVATE VOG_OPTIX)
    target_include_directories(${target} SYSTEM PRIVATE ${VOG_OPTIX_INCLUDE})
    target_link_libraries(${target} PRIVATE ${CMAKE_DL_LIBS})
endfunction()
