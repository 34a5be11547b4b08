# Sets SKINSLIDE_USD_INCLUDES and SKINSLIDE_USD_VERSION for building against the wheel usd-core.
#
# The wheels pxr-*-dev have pxr/sdf/layer.h where OpenUSD has pxr/usd/sdf/layer.h: a folder of forwarding headers gives those
# names. usd-core holds TBB 2020, the wheels ask for a newer one whose classes have other sizes: the headers of 2020 go first.
find_package(Python 3.11 REQUIRED COMPONENTS Interpreter Development.Module)
# pyproject.toml names this version too; tests/install/test_packaging.py compares.
set(usd_wheels 26.8)
set(tbb_requirement tbb-devel==2020.0.133)
set(SKINSLIDE_USD_VERSION 0.${usd_wheels})
set(base_libraries arch tf gf js trace work plug vt ts)
set(usd_libraries ar sdf pcp)

execute_process(
  COMMAND "${Python_EXECUTABLE}" -c
          "import importlib.metadata as m; print(m.version('pxr-pcp-dev'), m.distribution('pxr-pcp-dev').locate_file(''), sep=';')"
  OUTPUT_VARIABLE found
  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET
  RESULT_VARIABLE missing)
list(POP_FRONT found version)
if(missing OR NOT version STREQUAL usd_wheels)
  message(FATAL_ERROR "The file format needs USD's headers: ${Python_EXECUTABLE} -m pip install pxr-pcp-dev==${usd_wheels}, "
                      "or a full OpenUSD with -Dpxr_DIR=..., or leave it out with -DSKINSLIDE_FILE_FORMAT=OFF")
endif()
set(wheels "${found}")

# ---- Forwarding headers ----

set(forwarding "${CMAKE_CURRENT_BINARY_DIR}/forwarding")
file(WRITE "${forwarding}/pxr/pxr.h.new" "#include \"pxr/arch/pxr.h\"
#define PXR_VERSION ARCH_VERSION
#define PXR_NAMESPACE_OPEN_SCOPE ARCH_NAMESPACE_OPEN_SCOPE
#define PXR_NAMESPACE_CLOSE_SCOPE ARCH_NAMESPACE_CLOSE_SCOPE
#define PXR_NAMESPACE_USING_DIRECTIVE ARCH_NAMESPACE_USING_DIRECTIVE
")
file(COPY_FILE "${forwarding}/pxr/pxr.h.new" "${forwarding}/pxr/pxr.h" ONLY_IF_DIFFERENT)
foreach(library IN LISTS base_libraries usd_libraries)
  set(folder usd)
  if(library IN_LIST base_libraries)
    set(folder base)
  endif()
  file(GLOB headers RELATIVE "${wheels}/pxr-${library}/include" "${wheels}/pxr-${library}/include/pxr/${library}/*.h")
  foreach(header IN LISTS headers)
    get_filename_component(name "${header}" NAME)
    set(forward "${forwarding}/pxr/${folder}/${library}/${name}")
    if(NOT EXISTS "${forward}")
      file(WRITE "${forward}" "#include \"${header}\"\n")
    endif()
  endforeach()
  list(APPEND library_includes "${wheels}/pxr-${library}/include")
endforeach()

# ---- The headers of TBB 2020: of this Python, else fetched, as they are a wheel that depends on one that does not exist ----

execute_process(
  COMMAND "${Python_EXECUTABLE}" -c "import sysconfig; print(sysconfig.get_path('data'))"
  OUTPUT_VARIABLE prefix
  OUTPUT_STRIP_TRAILING_WHITESPACE)
find_path(SKINSLIDE_TBB_INCLUDE tbb/tbb_stddef.h HINTS "${prefix}/include" "${CMAKE_CURRENT_BINARY_DIR}/tbb/include"
          NO_DEFAULT_PATH)
if(NOT SKINSLIDE_TBB_INCLUDE)
  set(tbb "${CMAKE_CURRENT_BINARY_DIR}/tbb")
  execute_process(COMMAND "${Python_EXECUTABLE}" -m pip install -q --disable-pip-version-check --no-deps --target "${tbb}"
                          ${tbb_requirement} RESULT_VARIABLE missing)
  if(missing)
    message(FATAL_ERROR "The file format needs headers: ${Python_EXECUTABLE} -m pip install --no-deps ${tbb_requirement}, "
                        "or name their folder with -DSKINSLIDE_TBB_INCLUDE=...")
  endif()
  find_path(SKINSLIDE_TBB_INCLUDE tbb/tbb_stddef.h HINTS "${tbb}/include" NO_DEFAULT_PATH REQUIRED)
endif()

set(SKINSLIDE_USD_INCLUDES "${forwarding}" "${SKINSLIDE_TBB_INCLUDE}" ${library_includes} "${wheels}/pxr-boost/include"
                           "${wheels}/pxr-pegtl/include" ${Python_INCLUDE_DIRS})
