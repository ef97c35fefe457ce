# Writes the guides into a C++ file: OUTPUT from the *.md files of GUIDES, in the order of NAMES (separated by commas), laid
# out for a terminal by PANDOC.
set(code "// Written by client/cli/guides/embed.cmake.\n#include \"client/cli/guides/guides.hpp\"\n\n")
string(APPEND code "namespace collided::cli {\nnamespace {\nconstexpr Guide kGuides[] = {\n")
string(REPLACE "," ";" names "${NAMES}")
foreach(name ${names})
  execute_process(COMMAND ${PANDOC} -f commonmark+pipe_tables -L ${CMAKE_CURRENT_LIST_DIR}/guide.lua -t plain --columns=80 ${GUIDES}/${name}.md
    OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
  string(APPEND code "    {\"${name}\", R\"collided_guide(${text})collided_guide\"},\n")
endforeach()
string(APPEND code "};\n}  // namespace\n\nstd::span<const Guide> guides() { return kGuides; }\n\n}  // namespace collided::cli\n")
file(WRITE ${OUTPUT} "${code}")
