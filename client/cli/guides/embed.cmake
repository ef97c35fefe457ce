# Writes the guides into a C++ file: OUTPUT from the *.md files of GUIDES, in the order of NAMES (separated by commas).
set(delimiter "collided_guide")
set(code "// Written by client/cli/guides/embed.cmake.\n#include \"client/cli/guides/guides.hpp\"\n\n")
string(APPEND code "namespace collided::cli {\nnamespace {\nconstexpr Guide kGuides[] = {\n")
string(REPLACE "," ";" names "${NAMES}")
foreach(name ${names})
  file(READ ${GUIDES}/${name}.md text)
  # A compiler need not take more than 65,536 bytes of one literal; neighbours are joined.
  string(REPLACE "\n## " ")${delimiter}\"\n    R\"${delimiter}(\n## " text "${text}")
  string(APPEND code "    {\"${name}\", R\"${delimiter}(${text})${delimiter}\"},\n")
endforeach()
string(APPEND code "};\n}  // namespace\n\nstd::span<const Guide> guides() { return kGuides; }\n\n}  // namespace collided::cli\n")
file(WRITE ${OUTPUT} "${code}")
