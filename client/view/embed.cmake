# Writes the page into a C++ file: OUTPUT from the files of PAGE. The scripts become one, in the order
# in which they use each other, in a scope of their own.
set(delimiter "collided_page")
set(script "(() => {\n\"use strict\";\n")
foreach(part math text camera shaders_seen shaders_round shaders_ink renderer solids levels world contacts standing labels picture source history timeline
    recordings things coloring selected panels events matrix answers tools asking others controls main)
  file(READ ${PAGE}/${part}.js text)
  string(APPEND script "${text}\n")
endforeach()
string(APPEND script "})();\n")
file(READ ${PAGE}/index.html index)
file(READ ${PAGE}/view.css style)

set(code "// Written by client/view/embed.cmake.\n#include \"client/view/assets.hpp\"\n\nnamespace collided::view {\nnamespace {\n")
string(APPEND code "constexpr Asset kAssets[] = {\n")
function(add_asset path type variable)
  string(APPEND code "    {\"${path}\", \"${type}\", R\"${delimiter}(${${variable}})${delimiter}\"},\n")
  set(code "${code}" PARENT_SCOPE)
endfunction()
add_asset("/" "text/html; charset=utf-8" index)
add_asset("/view.css" "text/css; charset=utf-8" style)
add_asset("/view.js" "text/javascript; charset=utf-8" script)
string(APPEND code "};\n}  // namespace\n\nstd::span<const Asset> assets() {\n  return kAssets;\n}\n\n}  // namespace collided::view\n")
file(WRITE ${OUTPUT} "${code}")
