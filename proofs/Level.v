(* A level that varies: F_c(t) and F_s(t) are inputs, as the velocity is, and may change in any piecewise continuous way.

   p holds the smallest F_c and the largest F_s that occur; within_levels says that the inputs keep to them. *)
From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Stribeck Require Import Laws Motion Power Terms Continuous Relaxation Passive.
Open Scope R_scope.

(* --- lugre --- *)
Theorem lugre_level_bounded p : lugre.allowed p ->
  keeps (varying lugre.dz_dt p) (within_levels p) (lugre.z_bound p).
Proof. intros H u z a b M Hu. apply (varying_bounded _ _ _ _ _ lugre_form p H u z a b M Hu). Qed.
Theorem lugre_level_passive p : lugre.allowed p -> lugre.claims_passive p ->
  storage (varying lugre.dz_dt p) (within_levels p) (varying_power lugre.friction p)
    (within (lugre.z_bound p)) (lugre.stored_energy p).
Proof. intros H HL. by_law lugre_form constant_damping. unfold no_excess; lra. Qed.
Theorem lugre_level_passive_damped p : lugre.allowed_v_d p -> damped p (no_excess p) ->
  storage (varying lugre.dz_dt p) (within_levels p) (varying_power lugre.friction_v_d p) any (lugre.stored_energy p).
Proof.
  intros H D. assert (H' : lugre.allowed p) by (known_v_d H; repeat split; lra).
  by_law lugre_form sigma_1_at. by_damping H D.
Qed.

(* --- lugre_majorant --- *)
Theorem lugre_majorant_level_bounded p : lugre_majorant.allowed p ->
  keeps (varying lugre_majorant.dz_dt p) (within_levels p) (lugre_majorant.z_bound p).
Proof. intros H u z a b M Hu. apply (varying_bounded _ _ _ _ _ lugre_majorant_form p H u z a b M Hu). Qed.
Theorem lugre_majorant_level_passive p : lugre_majorant.allowed p -> lugre_majorant.claims_passive p ->
  storage (varying lugre_majorant.dz_dt p) (within_levels p) (varying_power lugre_majorant.friction p)
    (within (lugre_majorant.z_bound p)) (lugre_majorant.stored_energy p).
Proof. intros H [HL Hm]. by_law lugre_majorant_form constant_damping. Qed.
Theorem lugre_majorant_level_passive_damped p : lugre_majorant.allowed_v_d p -> damped p (excess_atan p) ->
  storage (varying lugre_majorant.dz_dt p) (within_levels p) (varying_power lugre_majorant.friction_v_d p) any (lugre_majorant.stored_energy p).
Proof.
  intros H D. assert (H' : lugre_majorant.allowed p) by (known_v_d H; repeat split; lra).
  by_law lugre_majorant_form sigma_1_at. by_damping H D.
Qed.

(* --- lugre_majorant_sqrt --- *)
Theorem lugre_majorant_sqrt_level_bounded p : lugre_majorant_sqrt.allowed p ->
  keeps (varying lugre_majorant_sqrt.dz_dt p) (within_levels p) (lugre_majorant_sqrt.z_bound p).
Proof. intros H u z a b M Hu. apply (varying_bounded _ _ _ _ _ lugre_majorant_sqrt_form p H u z a b M Hu). Qed.
Theorem lugre_majorant_sqrt_level_passive p : lugre_majorant_sqrt.allowed p -> lugre_majorant_sqrt.claims_passive p ->
  storage (varying lugre_majorant_sqrt.dz_dt p) (within_levels p) (varying_power lugre_majorant_sqrt.friction p)
    (within (lugre_majorant_sqrt.z_bound p)) (lugre_majorant_sqrt.stored_energy p).
Proof. intros H [HL Hm]. by_law lugre_majorant_sqrt_form constant_damping. Qed.
Theorem lugre_majorant_sqrt_level_passive_damped p : lugre_majorant_sqrt.allowed_v_d p -> damped p (excess_sqrt p) ->
  storage (varying lugre_majorant_sqrt.dz_dt p) (within_levels p) (varying_power lugre_majorant_sqrt.friction_v_d p) any (lugre_majorant_sqrt.stored_energy p).
Proof.
  intros H D. assert (H' : lugre_majorant_sqrt.allowed p) by (known_v_d H; repeat split; lra).
  by_law lugre_majorant_sqrt_form sigma_1_at. by_damping H D.
Qed.

(* --- lugre_majorant_compact --- *)
Theorem lugre_majorant_compact_level_bounded p : lugre_majorant_compact.allowed p ->
  keeps (varying lugre_majorant_compact.dz_dt p) (within_levels p) (lugre_majorant_compact.z_bound p).
Proof. intros H u z a b M Hu. apply (varying_bounded _ _ _ _ _ lugre_majorant_compact_form p H u z a b M Hu). Qed.
Theorem lugre_majorant_compact_level_passive p : lugre_majorant_compact.allowed p -> lugre_majorant_compact.claims_passive p ->
  storage (varying lugre_majorant_compact.dz_dt p) (within_levels p) (varying_power lugre_majorant_compact.friction p)
    (within (lugre_majorant_compact.z_bound p)) (lugre_majorant_compact.stored_energy p).
Proof. intros H [HL Hm]. by_law lugre_majorant_compact_form constant_damping. Qed.
Theorem lugre_majorant_compact_level_passive_damped p : lugre_majorant_compact.allowed_v_d p -> damped p (excess_compact p) ->
  storage (varying lugre_majorant_compact.dz_dt p) (within_levels p) (varying_power lugre_majorant_compact.friction_v_d p) any (lugre_majorant_compact.stored_energy p).
Proof.
  intros H D. assert (H' : lugre_majorant_compact.allowed p) by (known_v_d H; repeat split; lra).
  by_law lugre_majorant_compact_form sigma_1_at. by_damping H D.
Qed.

(* --- elastoplastic --- *)
Theorem elastoplastic_level_bounded p : elastoplastic.allowed p ->
  keeps (varying elastoplastic.dz_dt p) (within_levels p) (elastoplastic.z_bound p).
Proof. intros H u z a b M Hu. apply (varying_bounded _ _ _ _ _ elastoplastic_form p H u z a b M Hu). Qed.
Theorem elastoplastic_level_passive p : elastoplastic.allowed p -> elastoplastic.claims_passive p ->
  storage (varying elastoplastic.dz_dt p) (within_levels p) (varying_power elastoplastic.friction p)
    (within (elastoplastic.z_bound p)) (elastoplastic.stored_energy p).
Proof. intros H HL. by_law elastoplastic_form constant_damping. unfold no_excess; lra. Qed.
Theorem elastoplastic_level_passive_damped p : elastoplastic.allowed_v_d p -> damped p (no_excess p) ->
  storage (varying elastoplastic.dz_dt p) (within_levels p) (varying_power elastoplastic.friction_v_d p) any (elastoplastic.stored_energy p).
Proof.
  intros H D. assert (H' : elastoplastic.allowed p) by (known_v_d H; repeat split; lra).
  by_law elastoplastic_form sigma_1_at. by_damping H D.
Qed.

(* --- elastoplastic_majorant --- *)
Theorem elastoplastic_majorant_level_bounded p : elastoplastic_majorant.allowed p ->
  keeps (varying elastoplastic_majorant.dz_dt p) (within_levels p) (elastoplastic_majorant.z_bound p).
Proof. intros H u z a b M Hu. apply (varying_bounded _ _ _ _ _ elastoplastic_majorant_form p H u z a b M Hu). Qed.
Theorem elastoplastic_majorant_level_passive p : elastoplastic_majorant.allowed p -> elastoplastic_majorant.claims_passive p ->
  storage (varying elastoplastic_majorant.dz_dt p) (within_levels p) (varying_power elastoplastic_majorant.friction p)
    (within (elastoplastic_majorant.z_bound p)) (elastoplastic_majorant.stored_energy p).
Proof. intros H [HL Hm]. by_law elastoplastic_majorant_form constant_damping. Qed.
Theorem elastoplastic_majorant_level_passive_damped p : elastoplastic_majorant.allowed_v_d p -> damped p (excess_atan p) ->
  storage (varying elastoplastic_majorant.dz_dt p) (within_levels p) (varying_power elastoplastic_majorant.friction_v_d p) any (elastoplastic_majorant.stored_energy p).
Proof.
  intros H D. assert (H' : elastoplastic_majorant.allowed p) by (known_v_d H; repeat split; lra).
  by_law elastoplastic_majorant_form sigma_1_at. by_damping H D.
Qed.

(* --- elastoplastic_majorant_sqrt --- *)
Theorem elastoplastic_majorant_sqrt_level_bounded p : elastoplastic_majorant_sqrt.allowed p ->
  keeps (varying elastoplastic_majorant_sqrt.dz_dt p) (within_levels p) (elastoplastic_majorant_sqrt.z_bound p).
Proof. intros H u z a b M Hu. apply (varying_bounded _ _ _ _ _ elastoplastic_majorant_sqrt_form p H u z a b M Hu). Qed.
Theorem elastoplastic_majorant_sqrt_level_passive p : elastoplastic_majorant_sqrt.allowed p -> elastoplastic_majorant_sqrt.claims_passive p ->
  storage (varying elastoplastic_majorant_sqrt.dz_dt p) (within_levels p) (varying_power elastoplastic_majorant_sqrt.friction p)
    (within (elastoplastic_majorant_sqrt.z_bound p)) (elastoplastic_majorant_sqrt.stored_energy p).
Proof. intros H [HL Hm]. by_law elastoplastic_majorant_sqrt_form constant_damping. Qed.
Theorem elastoplastic_majorant_sqrt_level_passive_damped p : elastoplastic_majorant_sqrt.allowed_v_d p -> damped p (excess_sqrt p) ->
  storage (varying elastoplastic_majorant_sqrt.dz_dt p) (within_levels p) (varying_power elastoplastic_majorant_sqrt.friction_v_d p) any (elastoplastic_majorant_sqrt.stored_energy p).
Proof.
  intros H D. assert (H' : elastoplastic_majorant_sqrt.allowed p) by (known_v_d H; repeat split; lra).
  by_law elastoplastic_majorant_sqrt_form sigma_1_at. by_damping H D.
Qed.

(* --- elastoplastic_majorant_compact --- *)
Theorem elastoplastic_majorant_compact_level_bounded p : elastoplastic_majorant_compact.allowed p ->
  keeps (varying elastoplastic_majorant_compact.dz_dt p) (within_levels p) (elastoplastic_majorant_compact.z_bound p).
Proof. intros H u z a b M Hu. apply (varying_bounded _ _ _ _ _ elastoplastic_majorant_compact_form p H u z a b M Hu). Qed.
Theorem elastoplastic_majorant_compact_level_passive p : elastoplastic_majorant_compact.allowed p -> elastoplastic_majorant_compact.claims_passive p ->
  storage (varying elastoplastic_majorant_compact.dz_dt p) (within_levels p) (varying_power elastoplastic_majorant_compact.friction p)
    (within (elastoplastic_majorant_compact.z_bound p)) (elastoplastic_majorant_compact.stored_energy p).
Proof. intros H [HL Hm]. by_law elastoplastic_majorant_compact_form constant_damping. Qed.
Theorem elastoplastic_majorant_compact_level_passive_damped p : elastoplastic_majorant_compact.allowed_v_d p -> damped p (excess_compact p) ->
  storage (varying elastoplastic_majorant_compact.dz_dt p) (within_levels p) (varying_power elastoplastic_majorant_compact.friction_v_d p) any (elastoplastic_majorant_compact.stored_energy p).
Proof.
  intros H D. assert (H' : elastoplastic_majorant_compact.allowed p) by (known_v_d H; repeat split; lra).
  by_law elastoplastic_majorant_compact_form sigma_1_at. by_damping H D.
Qed.

