# Makes a virtual environment, installs the package into it as a wheel would, and looks at what is there.
file(REMOVE_RECURSE ${VENV})
function(step)
    execute_process(COMMAND ${ARGV} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(result)
        message(FATAL_ERROR "${ARGV}\n${output}")
    endif()
endfunction()
step(${PYTHON} -m venv --without-pip --system-site-packages ${VENV})
execute_process(COMMAND ${VENV}/bin/python -c "import sysconfig; print(sysconfig.get_path('platlib'))"
                OUTPUT_VARIABLE packages OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
step(${CMAKE_COMMAND} --install ${BUILD_DIR} --component python --prefix ${packages})

file(GLOB_RECURSE found RELATIVE ${packages} ${packages}/*)
list(FILTER found EXCLUDE REGEX "distutils-precedence|__pycache__")
list(TRANSFORM found REPLACE "_vog\\..*\\.so" "_vog.so")
list(TRANSFORM found REPLACE "libvog\\.so\\..*" "libvog.so")
list(SORT found)
set(expected vog/__init__.py vog/__main__.py vog/_files.py vog/_grids.py vog/_load.py vog/_messages.py vog/_netcdf.py vog/_packages.py vog/_picture.py
    vog/_projection.py vog/_python.py vog/_readers.py vog/_show.py vog/_units.py vog/_vog.pyi vog/_vog.so vog/_vtk.py vog/_vtk_files.py vog/_widget.js vog/libvog.so vog/py.typed vog/report.py)
if(NOT "${found}" STREQUAL "${expected}")
    message(FATAL_ERROR "installed: ${found}\nexpected: ${expected}")
endif()
# The library that comes with the package is the one that is loaded, wherever this is run.
execute_process(COMMAND ${VENV}/bin/python -c "
import vog
loaded = {line.split()[-1] for line in open('/proc/self/maps') if 'libvog.so' in line}
assert loaded and all(path.startswith('${packages}/vog/') for path in loaded), loaded"
                WORKING_DIRECTORY / COMMAND_ERROR_IS_FATAL ANY)
