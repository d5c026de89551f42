(* The laws as contacts of a machine: at a constant level, and at one that varies with loads, position or temperature. *)
From Coq Require Import Reals Lra Psatz List.
From Coquelicot Require Import Coquelicot.
From Stribeck Require Import Laws Motion Power Terms Continuous Relaxation Passive Level Machine.
Open Scope R_scope.

Definition varying_contact (dz F : constants -> R -> R -> R) (p : constants) (dom : R -> Prop) : element :=
  {| input := Levels; vel := velocity; rate := varying dz p; force := varying F p; ok := within_levels p; domain := dom |}.

Ltac damping_facts form := auto using constant_damping_continuous, sigma_1_at_continuous;
  try (intros q v K; pose proof (r_constants _ _ _ _ _ form _ K);
    first [apply sigma_1_at_range; lra | unfold constant_damping; lra]).
Ltac as_contact form damping passive :=
  apply contact_stores; [apply (law_force_continuous _ _ _ _ _ damping _ form); damping_facts form|apply passive; assumption].
Ltac as_varying form damping passive :=
  split; [|split; [intros w; apply continuous_fst|apply passive; assumption]];
  intros u x t1 t2 P W; apply (varying_force_inside _ _ _ _ _ damping _ form) with (5 := P); damping_facts form.

(* --- lugre --- *)
Theorem lugre_contact p : lugre.allowed p -> lugre.claims_passive p ->
  stores_in (contact (lugre.dz_dt p) (lugre.friction p) (within (lugre.z_bound p))) (lugre.stored_energy p).
Proof. intros H C. as_contact lugre_form constant_damping lugre_passive. Qed.
Theorem lugre_varying_contact p : lugre.allowed p -> lugre.claims_passive p ->
  stores_in (varying_contact lugre.dz_dt lugre.friction p (within (lugre.z_bound p))) (lugre.stored_energy p).
Proof. intros H C. as_varying lugre_form constant_damping lugre_level_passive. Qed.
Theorem lugre_varying_contact_damped p : lugre.allowed_v_d p -> damped p (no_excess p) ->
  stores_in (varying_contact lugre.dz_dt lugre.friction_v_d p any) (lugre.stored_energy p).
Proof.
  intros H D. assert (H' : lugre.allowed p) by (known_v_d H; repeat split; lra).
  as_varying lugre_form sigma_1_at lugre_level_passive_damped.
Qed.

(* --- lugre_majorant --- *)
Theorem lugre_majorant_contact p : lugre_majorant.allowed p -> lugre_majorant.claims_passive p ->
  stores_in (contact (lugre_majorant.dz_dt p) (lugre_majorant.friction p) (within (lugre_majorant.z_bound p))) (lugre_majorant.stored_energy p).
Proof. intros H C. as_contact lugre_majorant_form constant_damping lugre_majorant_passive. Qed.
Theorem lugre_majorant_varying_contact p : lugre_majorant.allowed p -> lugre_majorant.claims_passive p ->
  stores_in (varying_contact lugre_majorant.dz_dt lugre_majorant.friction p (within (lugre_majorant.z_bound p))) (lugre_majorant.stored_energy p).
Proof. intros H C. as_varying lugre_majorant_form constant_damping lugre_majorant_level_passive. Qed.
Theorem lugre_majorant_varying_contact_damped p : lugre_majorant.allowed_v_d p -> damped p (excess_atan p) ->
  stores_in (varying_contact lugre_majorant.dz_dt lugre_majorant.friction_v_d p any) (lugre_majorant.stored_energy p).
Proof.
  intros H D. assert (H' : lugre_majorant.allowed p) by (known_v_d H; repeat split; lra).
  as_varying lugre_majorant_form sigma_1_at lugre_majorant_level_passive_damped.
Qed.

(* --- lugre_majorant_sqrt --- *)
Theorem lugre_majorant_sqrt_contact p : lugre_majorant_sqrt.allowed p -> lugre_majorant_sqrt.claims_passive p ->
  stores_in (contact (lugre_majorant_sqrt.dz_dt p) (lugre_majorant_sqrt.friction p) (within (lugre_majorant_sqrt.z_bound p))) (lugre_majorant_sqrt.stored_energy p).
Proof. intros H C. as_contact lugre_majorant_sqrt_form constant_damping lugre_majorant_sqrt_passive. Qed.
Theorem lugre_majorant_sqrt_varying_contact p : lugre_majorant_sqrt.allowed p -> lugre_majorant_sqrt.claims_passive p ->
  stores_in (varying_contact lugre_majorant_sqrt.dz_dt lugre_majorant_sqrt.friction p (within (lugre_majorant_sqrt.z_bound p))) (lugre_majorant_sqrt.stored_energy p).
Proof. intros H C. as_varying lugre_majorant_sqrt_form constant_damping lugre_majorant_sqrt_level_passive. Qed.
Theorem lugre_majorant_sqrt_varying_contact_damped p : lugre_majorant_sqrt.allowed_v_d p -> damped p (excess_sqrt p) ->
  stores_in (varying_contact lugre_majorant_sqrt.dz_dt lugre_majorant_sqrt.friction_v_d p any) (lugre_majorant_sqrt.stored_energy p).
Proof.
  intros H D. assert (H' : lugre_majorant_sqrt.allowed p) by (known_v_d H; repeat split; lra).
  as_varying lugre_majorant_sqrt_form sigma_1_at lugre_majorant_sqrt_level_passive_damped.
Qed.

(* --- lugre_majorant_compact --- *)
Theorem lugre_majorant_compact_contact p : lugre_majorant_compact.allowed p -> lugre_majorant_compact.claims_passive p ->
  stores_in (contact (lugre_majorant_compact.dz_dt p) (lugre_majorant_compact.friction p) (within (lugre_majorant_compact.z_bound p))) (lugre_majorant_compact.stored_energy p).
Proof. intros H C. as_contact lugre_majorant_compact_form constant_damping lugre_majorant_compact_passive. Qed.
Theorem lugre_majorant_compact_varying_contact p : lugre_majorant_compact.allowed p -> lugre_majorant_compact.claims_passive p ->
  stores_in (varying_contact lugre_majorant_compact.dz_dt lugre_majorant_compact.friction p (within (lugre_majorant_compact.z_bound p))) (lugre_majorant_compact.stored_energy p).
Proof. intros H C. as_varying lugre_majorant_compact_form constant_damping lugre_majorant_compact_level_passive. Qed.
Theorem lugre_majorant_compact_varying_contact_damped p : lugre_majorant_compact.allowed_v_d p -> damped p (excess_compact p) ->
  stores_in (varying_contact lugre_majorant_compact.dz_dt lugre_majorant_compact.friction_v_d p any) (lugre_majorant_compact.stored_energy p).
Proof.
  intros H D. assert (H' : lugre_majorant_compact.allowed p) by (known_v_d H; repeat split; lra).
  as_varying lugre_majorant_compact_form sigma_1_at lugre_majorant_compact_level_passive_damped.
Qed.

(* --- elastoplastic --- *)
Theorem elastoplastic_contact p : elastoplastic.allowed p -> elastoplastic.claims_passive p ->
  stores_in (contact (elastoplastic.dz_dt p) (elastoplastic.friction p) (within (elastoplastic.z_bound p))) (elastoplastic.stored_energy p).
Proof. intros H C. as_contact elastoplastic_form constant_damping elastoplastic_passive. Qed.
Theorem elastoplastic_varying_contact p : elastoplastic.allowed p -> elastoplastic.claims_passive p ->
  stores_in (varying_contact elastoplastic.dz_dt elastoplastic.friction p (within (elastoplastic.z_bound p))) (elastoplastic.stored_energy p).
Proof. intros H C. as_varying elastoplastic_form constant_damping elastoplastic_level_passive. Qed.
Theorem elastoplastic_varying_contact_damped p : elastoplastic.allowed_v_d p -> damped p (no_excess p) ->
  stores_in (varying_contact elastoplastic.dz_dt elastoplastic.friction_v_d p any) (elastoplastic.stored_energy p).
Proof.
  intros H D. assert (H' : elastoplastic.allowed p) by (known_v_d H; repeat split; lra).
  as_varying elastoplastic_form sigma_1_at elastoplastic_level_passive_damped.
Qed.

(* --- elastoplastic_majorant --- *)
Theorem elastoplastic_majorant_contact p : elastoplastic_majorant.allowed p -> elastoplastic_majorant.claims_passive p ->
  stores_in (contact (elastoplastic_majorant.dz_dt p) (elastoplastic_majorant.friction p) (within (elastoplastic_majorant.z_bound p))) (elastoplastic_majorant.stored_energy p).
Proof. intros H C. as_contact elastoplastic_majorant_form constant_damping elastoplastic_majorant_passive. Qed.
Theorem elastoplastic_majorant_varying_contact p : elastoplastic_majorant.allowed p -> elastoplastic_majorant.claims_passive p ->
  stores_in (varying_contact elastoplastic_majorant.dz_dt elastoplastic_majorant.friction p (within (elastoplastic_majorant.z_bound p))) (elastoplastic_majorant.stored_energy p).
Proof. intros H C. as_varying elastoplastic_majorant_form constant_damping elastoplastic_majorant_level_passive. Qed.
Theorem elastoplastic_majorant_varying_contact_damped p : elastoplastic_majorant.allowed_v_d p -> damped p (excess_atan p) ->
  stores_in (varying_contact elastoplastic_majorant.dz_dt elastoplastic_majorant.friction_v_d p any) (elastoplastic_majorant.stored_energy p).
Proof.
  intros H D. assert (H' : elastoplastic_majorant.allowed p) by (known_v_d H; repeat split; lra).
  as_varying elastoplastic_majorant_form sigma_1_at elastoplastic_majorant_level_passive_damped.
Qed.

(* --- elastoplastic_majorant_sqrt --- *)
Theorem elastoplastic_majorant_sqrt_contact p : elastoplastic_majorant_sqrt.allowed p -> elastoplastic_majorant_sqrt.claims_passive p ->
  stores_in (contact (elastoplastic_majorant_sqrt.dz_dt p) (elastoplastic_majorant_sqrt.friction p) (within (elastoplastic_majorant_sqrt.z_bound p))) (elastoplastic_majorant_sqrt.stored_energy p).
Proof. intros H C. as_contact elastoplastic_majorant_sqrt_form constant_damping elastoplastic_majorant_sqrt_passive. Qed.
Theorem elastoplastic_majorant_sqrt_varying_contact p : elastoplastic_majorant_sqrt.allowed p -> elastoplastic_majorant_sqrt.claims_passive p ->
  stores_in (varying_contact elastoplastic_majorant_sqrt.dz_dt elastoplastic_majorant_sqrt.friction p (within (elastoplastic_majorant_sqrt.z_bound p))) (elastoplastic_majorant_sqrt.stored_energy p).
Proof. intros H C. as_varying elastoplastic_majorant_sqrt_form constant_damping elastoplastic_majorant_sqrt_level_passive. Qed.
Theorem elastoplastic_majorant_sqrt_varying_contact_damped p : elastoplastic_majorant_sqrt.allowed_v_d p -> damped p (excess_sqrt p) ->
  stores_in (varying_contact elastoplastic_majorant_sqrt.dz_dt elastoplastic_majorant_sqrt.friction_v_d p any) (elastoplastic_majorant_sqrt.stored_energy p).
Proof.
  intros H D. assert (H' : elastoplastic_majorant_sqrt.allowed p) by (known_v_d H; repeat split; lra).
  as_varying elastoplastic_majorant_sqrt_form sigma_1_at elastoplastic_majorant_sqrt_level_passive_damped.
Qed.

(* --- elastoplastic_majorant_compact --- *)
Theorem elastoplastic_majorant_compact_contact p : elastoplastic_majorant_compact.allowed p -> elastoplastic_majorant_compact.claims_passive p ->
  stores_in (contact (elastoplastic_majorant_compact.dz_dt p) (elastoplastic_majorant_compact.friction p) (within (elastoplastic_majorant_compact.z_bound p))) (elastoplastic_majorant_compact.stored_energy p).
Proof. intros H C. as_contact elastoplastic_majorant_compact_form constant_damping elastoplastic_majorant_compact_passive. Qed.
Theorem elastoplastic_majorant_compact_varying_contact p : elastoplastic_majorant_compact.allowed p -> elastoplastic_majorant_compact.claims_passive p ->
  stores_in (varying_contact elastoplastic_majorant_compact.dz_dt elastoplastic_majorant_compact.friction p (within (elastoplastic_majorant_compact.z_bound p))) (elastoplastic_majorant_compact.stored_energy p).
Proof. intros H C. as_varying elastoplastic_majorant_compact_form constant_damping elastoplastic_majorant_compact_level_passive. Qed.
Theorem elastoplastic_majorant_compact_varying_contact_damped p : elastoplastic_majorant_compact.allowed_v_d p -> damped p (excess_compact p) ->
  stores_in (varying_contact elastoplastic_majorant_compact.dz_dt elastoplastic_majorant_compact.friction_v_d p any) (elastoplastic_majorant_compact.stored_energy p).
Proof.
  intros H D. assert (H' : elastoplastic_majorant_compact.allowed p) by (known_v_d H; repeat split; lra).
  as_varying elastoplastic_majorant_compact_form sigma_1_at elastoplastic_majorant_compact_level_passive_damped.
Qed.

