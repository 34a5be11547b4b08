// Lets other threads run Python while this one computes.
#ifndef SKINSLIDE_FORMAT_PYTHON_H
#define SKINSLIDE_FORMAT_PYTHON_H

namespace skinslide {

// The thread is without Python's lock for as long as this lives; nothing where it has none, or USD is without Python.
//
// As TF_PY_ALLOW_THREADS_IN_SCOPE, but for a thread that wants the lock back while the process exits: before Python 3.14 it
// is unwound, which ends in std::terminate. It stops here for good instead, as such threads do from 3.14 on.
class PythonReleased {
  public:
    PythonReleased();
    ~PythonReleased();
    PythonReleased(const PythonReleased &) = delete;
    PythonReleased &operator=(const PythonReleased &) = delete;

  private:
    void *_state = nullptr; // PyThreadState
};

} // namespace skinslide

#endif
