#include "client/cli/run.hpp"

int main(int argument_count, char** arguments) {
  return collided::cli::run_process(argument_count, arguments, {.verbs = {{"keys", collided::cli::make_keys}}});
}
