// What a rank says when the job ends from outside: a node was lost, the time is over, somebody has cancelled it.
#pragma once

#include <string>

namespace pliant::app {

/// From now on SIGTERM and SIGINT print this line and end the process with exit status 1. For the main thread; an empty
/// text ends it silently.
void say_at_end(const std::string& text);

}  // namespace pliant::app
