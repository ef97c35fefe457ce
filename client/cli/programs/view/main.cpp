#include "client/cli/run.hpp"

int main(int argument_count, char** arguments) {
  return collided::cli::run_process(argument_count, arguments, {.verbs = {{"view", collided::cli::make_view}}});
}
