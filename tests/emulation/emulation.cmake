# vog_add_emulated_gpu(TARGET): adds the GPU renderers to TARGET, on a GPU in host memory (tests/emulation). With
# OptiX's headers (OptiX_ROOT) the host's calls of OptiX run too, through the function table of a library that
# takes the driver's place; without them, everything but these calls.
function(vog_add_emulated_gpu target)
    set(gpu ${PROJECT_SOURCE_DIR}/src/render/gpu)
    set(emulation ${PROJECT_SOURCE_DIR}/tests/emulation)
    set(kernels ${gpu}/cuda_splat.cu ${gpu}/chords/chord_kernels.cu ${gpu}/sums/sums_kernels.cu
        ${gpu}/optix/optix_programs.cu)
    add_library(${target}_gpu OBJECT ${gpu}/cuda_memory.cpp ${gpu}/cuda_passes.cpp ${gpu}/cuda_renderer.cpp
                ${kernels} ${gpu}/chords/gpu_pictures.cpp ${gpu}/chords/gpu_picture_sums.cpp ${gpu}/sums/gpu_sums.cpp
                ${gpu}/optix/optix_chords.cpp ${gpu}/optix/optix_film.cpp
                ${gpu}/optix/optix_model.cpp ${gpu}/optix/optix_volume.cpp ${gpu}/voxels/voxel_scene.cpp
                ${gpu}/voxels/gpu_volumes.cpp ${emulation}/cuda/memory.cpp
                ${emulation}/cuda/streams.cpp ${emulation}/cuda/blocks.cpp ${emulation}/device/traversal.cpp)
    # The compiler does not know .cu: as C++, with the qualifiers of tests/emulation/cuda.
    set(options "-x;c++;-DVOG_FLOAT_PAIRS;-Wno-conversion")
    if(VOG_SANITIZE)
        # Executed lines are counted, for tests/emulation/coverage.py. Clang counts before it optimises: the same lines with -O1.
        list(APPEND options "--coverage;-fprofile-update=atomic;-DVOG_EMULATED_KERNEL")
    elseif(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
        # GCC 12 takes (double)(float)v for v where it vectorizes exact() of float_pair.h (-O2 and up).
        list(APPEND options -fno-tree-slp-vectorize)
    endif()
    set_source_files_properties(${kernels} PROPERTIES LANGUAGE CXX COMPILE_OPTIONS "${options}")
    if(VOG_SANITIZE)  # as GCC says it; Clang has a macro of its own
        set_source_files_properties(${emulation}/cuda/blocks.cpp PROPERTIES COMPILE_DEFINITIONS __SANITIZE_ADDRESS__)
    endif()
    set_source_files_properties(${gpu}/optix/optix_programs.cu PROPERTIES INCLUDE_DIRECTORIES ${emulation}/device)
    set_target_properties(${target}_gpu PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_include_directories(${target}_gpu PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/src
                               ${emulation} ${emulation}/cuda)
    target_include_directories(${target}_gpu SYSTEM PRIVATE ${VOG_NANOVDB_INCLUDE})
    target_link_libraries(${target}_gpu PRIVATE vog_flags fmt::fmt TBB::tbb)
    target_compile_options(${target}_gpu PRIVATE $<$<BOOL:${VOG_SANITIZE}>:-O1>)
    # Buffers of OpenGL are those of the window's context.
    find_path(VOG_GL_INCLUDE GL/gl.h)
    if(VOG_VIEWER AND VOG_GL_INCLUDE)
        find_package(PkgConfig REQUIRED)
        pkg_check_modules(emulated_gl REQUIRED IMPORTED_TARGET epoxy)
        target_sources(${target}_gpu PRIVATE ${gpu}/sums/gl_sums.cpp ${emulation}/cuda/graphics.cpp)
        target_link_libraries(${target}_gpu PRIVATE PkgConfig::emulated_gl)
        target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:PkgConfig::emulated_gl>)
        set(VOG_EMULATED_GL ON PARENT_SCOPE)
    endif()
    find_path(VOG_OPTIX_INCLUDE optix.h HINTS ${OptiX_ROOT}/include $ENV{OptiX_ROOT}/include NO_DEFAULT_PATH)
    if(VOG_OPTIX_INCLUDE)
        message(STATUS "Emulated GPU: OptiX's headers in ${VOG_OPTIX_INCLUDE}, its function table too")
        target_sources(${target}_gpu PRIVATE ${gpu}/optix/optix_device.cpp ${gpu}/optix/optix_pipeline.cpp
                       ${gpu}/optix/optix_hierarchy.cpp ${emulation}/host/module.cpp)
        add_library(nvoptix SHARED ${emulation}/host/function_table.cpp)
        set_target_properties(nvoptix PROPERTIES SOVERSION 1)
        target_include_directories(nvoptix PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/src
                                   ${emulation} ${emulation}/cuda)
        target_link_libraries(nvoptix PRIVATE ${target} vog_flags)
        foreach(part ${target}_gpu nvoptix)
            target_include_directories(${part} SYSTEM PRIVATE ${VOG_OPTIX_INCLUDE})
        endforeach()
        # optixInit looks for the driver's library by name.
        set_target_properties(${target} PROPERTIES BUILD_RPATH ${CMAKE_CURRENT_BINARY_DIR})
    else()
        message(STATUS "Emulated GPU: no OptiX headers (OptiX_ROOT), so OptiX's function table is not emulated")
        target_sources(${target}_gpu PRIVATE ${emulation}/device/pipeline.cpp)
    endif()
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:${target}_gpu>)
    target_link_libraries(${target} PRIVATE ${CMAKE_DL_LIBS})
    target_link_options(${target} PRIVATE $<$<BOOL:${VOG_SANITIZE}>:--coverage>)
endfunction()
