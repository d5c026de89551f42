/* FMI 3.0 as this FMU implements it: types, constants and functions as the standard names them. */
#ifndef FMI3_H
#define FMI3_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

{% include "fmi_export.h" %}

#define fmi3Version "3.0"
#define fmi3False false
#define fmi3True true

typedef void *fmi3Instance, *fmi3InstanceEnvironment, *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8, fmi3Byte;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean, fmi3Clock;
typedef char fmi3Char;
typedef const fmi3Char *fmi3String;
typedef const fmi3Byte *fmi3Binary;

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum { fmi3Independent, fmi3Constant, fmi3Fixed, fmi3Tunable, fmi3Discrete, fmi3Dependent } fmi3DependencyKind;
typedef enum { fmi3IntervalNotYetKnown, fmi3IntervalUnchanged, fmi3IntervalChanged } fmi3IntervalQualifier;

/* What the importer lends: only the first is used here. */
typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String category, fmi3String message);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment, fmi3Float64 time, fmi3Boolean setRequested,
    fmi3Boolean getAllowed, fmi3Boolean stepFinished, fmi3Boolean canReturnEarly, fmi3Boolean *earlyReturnRequested,
    fmi3Float64 *earlyReturnTime);
typedef void (*fmi3LockPreemptionCallback)(void);
typedef void (*fmi3UnlockPreemptionCallback)(void);

FMI_EXPORT const char *fmi3GetVersion(void);
FMI_EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance i, fmi3Boolean on, size_t n, const fmi3String categories[]);
FMI_EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String path,
    fmi3Boolean visible, fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log);
FMI_EXPORT fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String path,
    fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
    const fmi3ValueReference required[], size_t n, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback update);
FMI_EXPORT fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String path,
    fmi3Boolean visible, fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock);
FMI_EXPORT void fmi3FreeInstance(fmi3Instance i);
FMI_EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance i, fmi3Boolean toleranceDefined,
    fmi3Float64 tolerance, fmi3Float64 startTime, fmi3Boolean stopTimeDefined, fmi3Float64 stopTime);
FMI_EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance i);
FMI_EXPORT fmi3Status fmi3EnterEventMode(fmi3Instance i);
FMI_EXPORT fmi3Status fmi3Terminate(fmi3Instance i);
FMI_EXPORT fmi3Status fmi3EnterConfigurationMode(fmi3Instance i);
FMI_EXPORT fmi3Status fmi3ExitConfigurationMode(fmi3Instance i);
FMI_EXPORT fmi3Status fmi3EnterStepMode(fmi3Instance i);
FMI_EXPORT fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance i);
FMI_EXPORT fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance i);
FMI_EXPORT fmi3Status fmi3Reset(fmi3Instance i);
FMI_EXPORT fmi3Status fmi3GetFloat64(fmi3Instance i, const fmi3ValueReference references[], size_t n,
    fmi3Float64 values[], size_t count);
FMI_EXPORT fmi3Status fmi3SetFloat64(fmi3Instance i, const fmi3ValueReference references[], size_t n,
    const fmi3Float64 values[], size_t count);
FMI_EXPORT fmi3Status fmi3GetFloat32(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3Float32 values[],
    size_t count);
FMI_EXPORT fmi3Status fmi3SetFloat32(fmi3Instance i, const fmi3ValueReference r[], size_t n,
    const fmi3Float32 values[], size_t count);
FMI_EXPORT fmi3Status fmi3GetInt8(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3Int8 values[],
    size_t count);
FMI_EXPORT fmi3Status fmi3SetInt8(fmi3Instance i, const fmi3ValueReference r[], size_t n, const fmi3Int8 values[],
    size_t count);
FMI_EXPORT fmi3Status fmi3GetUInt8(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3UInt8 values[],
    size_t count);
FMI_EXPORT fmi3Status fmi3SetUInt8(fmi3Instance i, const fmi3ValueReference r[], size_t n, const fmi3UInt8 values[],
    size_t count);
FMI_EXPORT fmi3Status fmi3GetInt16(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3Int16 values[],
    size_t count);
FMI_EXPORT fmi3Status fmi3SetInt16(fmi3Instance i, const fmi3ValueReference r[], size_t n, const fmi3Int16 values[],
    size_t count);
FMI_EXPORT fmi3Status fmi3GetUInt16(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3UInt16 values[],
    size_t count);
FMI_EXPORT fmi3Status fmi3SetUInt16(fmi3Instance i, const fmi3ValueReference r[], size_t n,
    const fmi3UInt16 values[], size_t count);
FMI_EXPORT fmi3Status fmi3GetInt32(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3Int32 values[],
    size_t count);
FMI_EXPORT fmi3Status fmi3SetInt32(fmi3Instance i, const fmi3ValueReference r[], size_t n, const fmi3Int32 values[],
    size_t count);
FMI_EXPORT fmi3Status fmi3GetUInt32(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3UInt32 values[],
    size_t count);
FMI_EXPORT fmi3Status fmi3SetUInt32(fmi3Instance i, const fmi3ValueReference r[], size_t n,
    const fmi3UInt32 values[], size_t count);
FMI_EXPORT fmi3Status fmi3GetInt64(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3Int64 values[],
    size_t count);
FMI_EXPORT fmi3Status fmi3SetInt64(fmi3Instance i, const fmi3ValueReference r[], size_t n, const fmi3Int64 values[],
    size_t count);
FMI_EXPORT fmi3Status fmi3GetUInt64(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3UInt64 values[],
    size_t count);
FMI_EXPORT fmi3Status fmi3SetUInt64(fmi3Instance i, const fmi3ValueReference r[], size_t n,
    const fmi3UInt64 values[], size_t count);
FMI_EXPORT fmi3Status fmi3GetBoolean(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3Boolean values[],
    size_t count);
FMI_EXPORT fmi3Status fmi3SetBoolean(fmi3Instance i, const fmi3ValueReference r[], size_t n,
    const fmi3Boolean values[], size_t count);
FMI_EXPORT fmi3Status fmi3GetString(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3String values[],
    size_t count);
FMI_EXPORT fmi3Status fmi3SetString(fmi3Instance i, const fmi3ValueReference r[], size_t n,
    const fmi3String values[], size_t count);
FMI_EXPORT fmi3Status fmi3GetBinary(fmi3Instance i, const fmi3ValueReference r[], size_t n, size_t sizes[],
    fmi3Binary values[], size_t count);
FMI_EXPORT fmi3Status fmi3SetBinary(fmi3Instance i, const fmi3ValueReference r[], size_t n, const size_t sizes[],
    const fmi3Binary values[], size_t count);
FMI_EXPORT fmi3Status fmi3GetClock(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3Clock values[]);
FMI_EXPORT fmi3Status fmi3SetClock(fmi3Instance i, const fmi3ValueReference r[], size_t n,
    const fmi3Clock values[]);
FMI_EXPORT fmi3Status fmi3GetIntervalDecimal(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3Float64 a[],
    fmi3IntervalQualifier b[]);
FMI_EXPORT fmi3Status fmi3GetIntervalFraction(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3UInt64 a[],
    fmi3UInt64 b[], fmi3IntervalQualifier c[]);
FMI_EXPORT fmi3Status fmi3GetShiftDecimal(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3Float64 a[]);
FMI_EXPORT fmi3Status fmi3GetShiftFraction(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3UInt64 a[],
    fmi3UInt64 b[]);
FMI_EXPORT fmi3Status fmi3SetIntervalDecimal(fmi3Instance i, const fmi3ValueReference r[], size_t n,
    const fmi3Float64 a[]);
FMI_EXPORT fmi3Status fmi3SetIntervalFraction(fmi3Instance i, const fmi3ValueReference r[], size_t n,
    const fmi3UInt64 a[], const fmi3UInt64 b[]);
FMI_EXPORT fmi3Status fmi3SetShiftDecimal(fmi3Instance i, const fmi3ValueReference r[], size_t n,
    const fmi3Float64 a[]);
FMI_EXPORT fmi3Status fmi3SetShiftFraction(fmi3Instance i, const fmi3ValueReference r[], size_t n,
    const fmi3UInt64 a[], const fmi3UInt64 b[]);
FMI_EXPORT fmi3Status fmi3ActivateModelPartition(fmi3Instance i, fmi3ValueReference clock, fmi3Float64 time);
FMI_EXPORT fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance i, fmi3ValueReference reference, size_t *n);
FMI_EXPORT fmi3Status fmi3GetVariableDependencies(fmi3Instance i, fmi3ValueReference dependent, size_t a[],
    fmi3ValueReference b[], size_t c[], fmi3DependencyKind d[], size_t n);
FMI_EXPORT fmi3Status fmi3GetFMUState(fmi3Instance i, fmi3FMUState *state);
FMI_EXPORT fmi3Status fmi3SetFMUState(fmi3Instance i, fmi3FMUState state);
FMI_EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance i, fmi3FMUState *state);
FMI_EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance i, fmi3FMUState state, size_t *size);
FMI_EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance i, fmi3FMUState state, fmi3Byte bytes[], size_t size);
FMI_EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance i, const fmi3Byte bytes[], size_t size,
    fmi3FMUState *state);
FMI_EXPORT fmi3Status fmi3GetDirectionalDerivative(fmi3Instance i, const fmi3ValueReference unknowns[],
    size_t nUnknowns, const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed,
    fmi3Float64 result[], size_t nResult);
FMI_EXPORT fmi3Status fmi3GetAdjointDerivative(fmi3Instance i, const fmi3ValueReference unknowns[], size_t nUnknowns,
    const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed, fmi3Float64 result[],
    size_t nResult);
FMI_EXPORT fmi3Status fmi3UpdateDiscreteStates(fmi3Instance i, fmi3Boolean *again, fmi3Boolean *terminate,
    fmi3Boolean *nominals, fmi3Boolean *states, fmi3Boolean *timeDefined, fmi3Float64 *time);
FMI_EXPORT fmi3Status fmi3CompletedIntegratorStep(fmi3Instance i, fmi3Boolean noSet, fmi3Boolean *event,
    fmi3Boolean *terminate);
FMI_EXPORT fmi3Status fmi3SetTime(fmi3Instance i, fmi3Float64 time);
FMI_EXPORT fmi3Status fmi3SetContinuousStates(fmi3Instance i, const fmi3Float64 x[], size_t n);
FMI_EXPORT fmi3Status fmi3GetContinuousStates(fmi3Instance i, fmi3Float64 x[], size_t n);
FMI_EXPORT fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance i, fmi3Float64 rates[], size_t n);
FMI_EXPORT fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance i, fmi3Float64 nominals[], size_t n);
FMI_EXPORT fmi3Status fmi3GetEventIndicators(fmi3Instance i, fmi3Float64 values[], size_t n);
FMI_EXPORT fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance i, size_t *n);
FMI_EXPORT fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance i, size_t *n);
FMI_EXPORT fmi3Status fmi3GetOutputDerivatives(fmi3Instance i, const fmi3ValueReference r[], size_t n,
    const fmi3Int32 orders[], fmi3Float64 values[], size_t count);
FMI_EXPORT fmi3Status fmi3DoStep(fmi3Instance i, fmi3Float64 point, fmi3Float64 step, fmi3Boolean noSet,
    fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last);

#endif
