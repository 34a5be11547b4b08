#include "pxr/pxr.h"
#if defined(PXR_PYTHON_SUPPORT_ENABLED)
#include <Python.h>
#endif

#include "pythonLock.h"

#include <chrono>
#include <cxxabi.h>
#include <thread>

namespace skinslide {

#if defined(PXR_PYTHON_SUPPORT_ENABLED)

namespace {

[[noreturn]] void stopForGood() {
    for (;;)
        std::this_thread::sleep_for(std::chrono::hours(1));
}

} // namespace

PythonReleased::PythonReleased() {
    if (Py_IsInitialized() && PyGILState_Check())
        _state = PyEval_SaveThread();
}

PythonReleased::~PythonReleased() {
    if (!_state)
        return;
    try {
        PyEval_RestoreThread(static_cast<PyThreadState *>(_state));
    } catch (abi::__forced_unwind &) {
        stopForGood();
    }
}

#else

PythonReleased::PythonReleased() = default;
PythonReleased::~PythonReleased() = default;

#endif

} // namespace skinslide
