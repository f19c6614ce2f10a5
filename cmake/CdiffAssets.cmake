# cdiff_assets(LAYER FILE CONSTANT ...): puts files of this folder into the library e2e_cdiff_LAYER, each as a constant of type
# core::Asset in the namespace cdiff::LAYER. A change of a file compiles it anew. What this writes lies in the build folder.
#
#   cdiff_assets(page assets/report.css kReportStyle)      # in the header: extern const core::Asset kReportStyle;
#
# The file is also the script that writes one source: cmake -DASSET=... -DCONSTANT=... -DNAMESPACE=... -DSOURCE=... -P CdiffAssets.cmake
if(CMAKE_SCRIPT_MODE_FILE)
  # Bytes and no string literal: compilers must take 64 KiB of those only, and an asset may hold anything.
  file(READ ${ASSET} bytes HEX)
  if(NOT bytes)
    message(FATAL_ERROR "${ASSET} is empty")
  endif()
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
  string(REGEX REPLACE "(0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,)" "\\1\n" bytes "${bytes}")
  file(WRITE ${SOURCE} "#include \"core/markup.h\"

namespace cdiff::${NAMESPACE} {
namespace {
constexpr unsigned char ${CONSTANT}Bytes[] = {
${bytes}};
}  // namespace

extern const core::Asset ${CONSTANT};
constexpr core::Asset ${CONSTANT}(${CONSTANT}Bytes);

}  // namespace cdiff::${NAMESPACE}
")
  return()
endif()

set(CDIFF_ASSETS_SCRIPT ${CMAKE_CURRENT_LIST_FILE})

function(cdiff_assets layer)
  set(pairs ${ARGN})
  while(pairs)
    list(GET pairs 0 file)
    list(GET pairs 1 constant)
    list(REMOVE_AT pairs 0 1)
    set(asset ${CMAKE_CURRENT_SOURCE_DIR}/${file})
    set(source ${CMAKE_CURRENT_BINARY_DIR}/${file}.cpp)
    add_custom_command(OUTPUT ${source}
                       COMMAND ${CMAKE_COMMAND} -DASSET=${asset} -DCONSTANT=${constant} -DNAMESPACE=${layer} -DSOURCE=${source}
                               -P ${CDIFF_ASSETS_SCRIPT}
                       DEPENDS ${asset} ${CDIFF_ASSETS_SCRIPT}
                       COMMENT "Embedding ${file}" VERBATIM)
    target_sources(e2e_cdiff_${layer} PRIVATE ${source})
  endwhile()
endfunction()
