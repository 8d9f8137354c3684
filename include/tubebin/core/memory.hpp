/// How memory is kept.
#pragma once

namespace tubebin {

/// For programs in which clouds of megabytes come and go: glibc would give their pages back each time, and clearing new ones
/// costs as much as filling them. For the whole process, from now on.
void keep_memory();

}  // namespace tubebin
