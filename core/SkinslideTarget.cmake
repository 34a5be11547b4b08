# What every target of ours is built with. Contraction is off so that a frame has the same bytes on every machine
# that has the same builds of our libraries.
function(skinslide_configure_target target)
  target_compile_features(${target} PRIVATE c_std_17 cxx_std_17)
  set_target_properties(${target} PROPERTIES C_EXTENSIONS OFF CXX_EXTENSIONS OFF C_VISIBILITY_PRESET hidden
                                           CXX_VISIBILITY_PRESET hidden)
  target_compile_definitions(${target} PRIVATE SKINSLIDE_VERSION="${PROJECT_VERSION}")
  target_compile_options(${target} PRIVATE -ffp-contract=off -fno-math-errno -Wall -Wextra -Wpedantic -Wshadow
                                           "$<$<COMPILE_LANGUAGE:C>:-Wstrict-prototypes;-Wmissing-prototypes>")
  if(SKINSLIDE_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(SKINSLIDE_SANITIZE)
    set(sanitizers -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_compile_options(${target} PRIVATE ${sanitizers})
    target_link_options(${target} PRIVATE ${sanitizers})
  endif()
endfunction()
