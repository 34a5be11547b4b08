// Lets other threads run Python while this one computes.
#ifndef SKINSLIDE_FORMAT_PYTHON_H
#define SKINSLIDE_FORMAT_PYTHON_H

namespace skinslide {

// Releases Python's lock for as long as this lives; does nothing if the thread does not hold it, or USD has no Python.
//
// Like TF_PY_ALLOW_THREADS_IN_SCOPE, except for a thread that wants the lock back while the process exits: before Python 3.14
// it is unwound, which ends in std::terminate. Here it stops for good instead, as such threads do from 3.14 on.
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
