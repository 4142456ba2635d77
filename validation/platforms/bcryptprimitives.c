/* The one function of Windows 10's bcryptprimitives.dll that Rust's standard library calls, for a Wine that lacks this library
   (before 8.18): random bytes for hash tables. It is laid beside the host and is no part of an FMU. */
#include <windows.h>
#include <ntsecapi.h>

__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE bytes, SIZE_T count)
{
    return RtlGenRandom(bytes, (ULONG)count);
}
