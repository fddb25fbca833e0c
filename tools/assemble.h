#pragma once

#include <string>

namespace tufa::tools {

/// The half of `tufa chunks` that makes one mesh of chunks.
struct AssembleArguments {
  std::string folder;
  std::string lods;  ///< "all:K", "random[:SEED]" or "camera:X,Y,Z"
  double pixelError = 1;
  std::string output;
  int threads = 0;
  bool check = false;
  bool json = false;
  bool quiet = false;
};

/// Reads the chunks, writes the mesh, reports what it found; returns the exit code.
int runAssemble(const AssembleArguments& arguments);

}  // namespace tufa::tools
