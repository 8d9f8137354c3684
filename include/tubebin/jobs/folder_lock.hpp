/// One run at a time in one output folder, or all shards of one run.
#pragma once

#include <string>

#include "tubebin/core/folder_entry.hpp"
#include "tubebin/jobs/shard.hpp"

namespace tubebin::jobs {

/// Holds an advisory lock on `folder`/.lock while it lives. Processes forked from its holder share it, so it is free
/// once all of them have ended, however they ended. File systems that keep no locks, as some of a network, give it to
/// everybody: it finds the mistake of starting two runs, and shards of one job don't depend on it.
class FolderLock {
 public:
  enum class Kind {
    exclusive,
    shared,  ///< of those who only read; no file is made for it
    shard    ///< of those who each make a shard of their own; it keeps those out who want the folder to themselves
  };

  /// Throws ConfigError where another run holds the folder (naming its process) and IoError where the lock file
  /// can't be made.
  explicit FolderLock(const OutputFolder& folder, Kind kind = Kind::exclusive);

  /// Of who only reads: makes no file. Throws as above.
  explicit FolderLock(const std::string& folder);

  /// Of one shard, which two runs can't pack into one tar at once, by a file of its own in `folder`. Throws IoError
  /// where another run holds it (as where a scheduler has lost sight of that run's host: starting again is right) and
  /// where the lock file can't be made.
  FolderLock(const OutputFolder& folder, const Shard& packed_shard);

  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  void require_free(const std::string& folder, Kind kind) const;

  FileDescriptor file_;
};

}  // namespace tubebin::jobs
