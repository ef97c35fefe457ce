#include "client/cli/programs/shell/prompt.hpp"
#include "client/cli/run.hpp"

int main(int argument_count, char** arguments) {
  return collided::cli::run_process(argument_count, arguments, {.prompted_lines = collided::cli::prompted_lines});
}
