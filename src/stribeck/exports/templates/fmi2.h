/* FMI 2.0 as this FMU implements it: types, constants and functions as the standard names them. */
#ifndef FMI2_H
#define FMI2_H

#include <stddef.h>

{% include "fmi_export.h" %}

#define fmi2TypesPlatform "default"
#define fmi2Version "2.0"
#define fmi2False 0
#define fmi2True 1

typedef void *fmi2Component, *fmi2ComponentEnvironment, *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer, fmi2Boolean;
typedef char fmi2Char, fmi2Byte;
typedef const fmi2Char *fmi2String;

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;

/* What the importer lends: only the logger is used here. */
typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String instance, fmi2Status, fmi2String category, fmi2String message, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

typedef struct {
    fmi2Boolean newDiscreteStatesNeeded, terminateSimulation;
    fmi2Boolean nominalsOfContinuousStatesChanged, valuesOfContinuousStatesChanged;
    fmi2Boolean nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;

FMI_EXPORT const char *fmi2GetTypesPlatform(void);
FMI_EXPORT const char *fmi2GetVersion(void);
FMI_EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component i, fmi2Boolean on, size_t n, const fmi2String categories[]);
FMI_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String path,
    const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging);
FMI_EXPORT void fmi2FreeInstance(fmi2Component i);
FMI_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component i, fmi2Boolean toleranceDefined, fmi2Real tolerance,
    fmi2Real startTime, fmi2Boolean stopTimeDefined, fmi2Real stopTime);
FMI_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component i);
FMI_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component i);
FMI_EXPORT fmi2Status fmi2EnterEventMode(fmi2Component i);
FMI_EXPORT fmi2Status fmi2EnterContinuousTimeMode(fmi2Component i);
FMI_EXPORT fmi2Status fmi2Terminate(fmi2Component i);
FMI_EXPORT fmi2Status fmi2Reset(fmi2Component i);
FMI_EXPORT fmi2Status fmi2GetReal(fmi2Component i, const fmi2ValueReference references[], size_t n,
    fmi2Real values[]);
FMI_EXPORT fmi2Status fmi2SetReal(fmi2Component i, const fmi2ValueReference references[], size_t n,
    const fmi2Real values[]);
FMI_EXPORT fmi2Status fmi2GetInteger(fmi2Component i, const fmi2ValueReference r[], size_t n, fmi2Integer values[]);
FMI_EXPORT fmi2Status fmi2SetInteger(fmi2Component i, const fmi2ValueReference r[], size_t n,
    const fmi2Integer values[]);
FMI_EXPORT fmi2Status fmi2GetBoolean(fmi2Component i, const fmi2ValueReference r[], size_t n, fmi2Boolean values[]);
FMI_EXPORT fmi2Status fmi2SetBoolean(fmi2Component i, const fmi2ValueReference r[], size_t n,
    const fmi2Boolean values[]);
FMI_EXPORT fmi2Status fmi2GetString(fmi2Component i, const fmi2ValueReference r[], size_t n, fmi2String values[]);
FMI_EXPORT fmi2Status fmi2SetString(fmi2Component i, const fmi2ValueReference r[], size_t n,
    const fmi2String values[]);
FMI_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component i, fmi2FMUstate *state);
FMI_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component i, fmi2FMUstate state);
FMI_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component i, fmi2FMUstate *state);
FMI_EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component i, fmi2FMUstate state, size_t *size);
FMI_EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component i, fmi2FMUstate state, fmi2Byte bytes[], size_t size);
FMI_EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component i, const fmi2Byte bytes[], size_t size,
    fmi2FMUstate *state);
FMI_EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component i, const fmi2ValueReference unknowns[],
    size_t nUnknowns, const fmi2ValueReference knowns[], size_t nKnowns, const fmi2Real seed[], fmi2Real result[]);
FMI_EXPORT fmi2Status fmi2NewDiscreteStates(fmi2Component i, fmi2EventInfo *info);
FMI_EXPORT fmi2Status fmi2CompletedIntegratorStep(fmi2Component i, fmi2Boolean noSet, fmi2Boolean *event,
    fmi2Boolean *terminate);
FMI_EXPORT fmi2Status fmi2SetTime(fmi2Component i, fmi2Real time);
FMI_EXPORT fmi2Status fmi2SetContinuousStates(fmi2Component i, const fmi2Real x[], size_t n);
FMI_EXPORT fmi2Status fmi2GetContinuousStates(fmi2Component i, fmi2Real x[], size_t n);
FMI_EXPORT fmi2Status fmi2GetDerivatives(fmi2Component i, fmi2Real rates[], size_t n);
FMI_EXPORT fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component i, fmi2Real nominals[], size_t n);
FMI_EXPORT fmi2Status fmi2GetEventIndicators(fmi2Component i, fmi2Real values[], size_t n);
FMI_EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component i, const fmi2ValueReference r[], size_t n,
    const fmi2Integer orders[], const fmi2Real values[]);
FMI_EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component i, const fmi2ValueReference r[], size_t n,
    const fmi2Integer orders[], fmi2Real values[]);
FMI_EXPORT fmi2Status fmi2DoStep(fmi2Component i, fmi2Real point, fmi2Real step, fmi2Boolean noSet);
FMI_EXPORT fmi2Status fmi2CancelStep(fmi2Component i);
FMI_EXPORT fmi2Status fmi2GetStatus(fmi2Component i, const fmi2StatusKind kind, fmi2Status *value);
FMI_EXPORT fmi2Status fmi2GetRealStatus(fmi2Component i, const fmi2StatusKind kind, fmi2Real *value);
FMI_EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component i, const fmi2StatusKind kind, fmi2Integer *value);
FMI_EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component i, const fmi2StatusKind kind, fmi2Boolean *value);
FMI_EXPORT fmi2Status fmi2GetStringStatus(fmi2Component i, const fmi2StatusKind kind, fmi2String *value);

#endif
