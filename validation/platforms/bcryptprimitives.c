/* The only function of Windows 10's bcryptprimitives.dll that Rust's standard library calls, random bytes for hash
   tables, for Wine before 8.18, which lacks this library. It is put into the folder of the host and is not part of an
   FMU. */
#include <windows.h>
#include <ntsecapi.h>

__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE bytes, SIZE_T count)
{
    return RtlGenRandom(bytes, (ULONG)count);
}
