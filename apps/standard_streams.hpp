// Standard streams that are closed or full, or whose reader goes away.
#pragma once

namespace pliant::app {

/// At the start of a program. Closed standard descriptors are occupied, so that no file that is opened later gets what
/// is printed; what standard error does not take is lost; a file above the limit of its size is an error, as on a full
/// disk, and not the end.
void secure_standard_streams();

/// What standard output does not take is lost, too, and a reader that goes away ends nothing: for work that must come
/// to its end. Before other threads are started.
void outlive_readers();

}  // namespace pliant::app
