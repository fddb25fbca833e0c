#pragma once

namespace tufa::tools {

/// Where memory ends, an exception is to become one line and exit code 3. What it passes on its way
/// takes memory too: OpenVDB and TBB free trees in parallel, in destructors that may not fail. So
/// some megabytes are kept back until the first allocation fails. Should that not be enough, the
/// program says that it is out of memory and ends, where it would be aborted.
void keepMemoryInReserve();

/// Has large arrays given back to the system as soon as they are freed, where the allocator would
/// keep those up to 32 MB for later ones of other sizes; of what smaller ones leave, all but some
/// megabytes.
void giveLargeMemoryBack();

/// Whether there is no room for a thread's stack. Safe in a signal handler.
[[nodiscard]] bool isMemoryAtItsEnd();

}  // namespace tufa::tools
