// The message if the job is ended from outside: a node was lost, the time limit was reached, or it was cancelled.
#pragma once

#include <string>

namespace pliant::app {

/// From now on SIGTERM and SIGINT print this line and end the process with exit status 1; silently if the text is
/// empty. Called by the main thread.
void say_at_end(const std::string& text);

}  // namespace pliant::app
